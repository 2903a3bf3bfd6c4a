"""Results as a tidy table: a row for each, with what it is of, from whom and when."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any
from uuid import UUID

from sqlalchemy import select

from palpate.store import schema
from palpate.store.archive_rows import entries_schema
from palpate.store.content import to_json
from palpate.store.decoding import entry_from, moment_from
from palpate.store.filters import Filter, Sort
from palpate.store.legible import reading
from palpate.store.listing import in_order, matching
from palpate.store.rows import counted, entry_columns
from palpate.store.seals import sealed_document
from palpate.store.store import Store
from palpate.store.units import deciding_units

if TYPE_CHECKING:
    import pyarrow

__all__ = ["entries_table"]

AT_ONCE = 2000


def entries_table(
    store: Store, wanted: Filter | None = None, sort: Sort | None = None, *, limit: int | None = None
) -> pyarrow.Table:
    """The results of the recordings that match, a row for each.

    The columns are those of ``entries.parquet`` in an archive: ``recording``, ``action``, ``dataset``, ``object``,
    ``gripper``, ``kind``, ``property``, ``value``, ``sd``, ``low``, ``high``, ``unit``, ``value_si``, ``sd_si``,
    ``label`` (the most probable one), ``document`` (the whole result as JSON), ``recorded_at`` and ``ground_truth``.
    ``entries_table(store).to_pandas()`` and ``polars.from_arrow(entries_table(store))`` are data frames.

    Parameters
    ----------
    store
        Where to look.
    wanted, sort
        Which recordings, and in which order; all, the last recorded first, unless given.
    limit
        Of how many recordings at most.

    Raises
    ------
    DamagedError
        If a recording is not what was written.
    """
    import pyarrow

    columns = entries_schema()
    with reading(store.engine) as connection:
        units = deciding_units(connection)
        found = connection.execution_options(yield_per=AT_ONCE).execute(_asked(wanted or Filter(), sort, limit))
        batches = [
            pyarrow.RecordBatch.from_pylist([line for row in part for line in _lines(row, units)], schema=columns)
            for part in found.mappings().partitions()
        ]
    return pyarrow.Table.from_batches(batches, schema=columns)


def _asked(wanted: Filter, sort: Sort | None, limit: int | None) -> Any:
    sort, recordings, things = sort or Sort(), schema.recordings, schema.things
    those = matching(wanted, sort, None, limit).subquery()
    names = ("uuid", "digest", "gripper", "document", "seal")
    asked = (
        select(*(recordings.c[name] for name in names), things.c.dataset, things.c.name)
        .join(those, those.c.id == recordings.c.id)
        .outerjoin(things, things.c.id == recordings.c.thing_id)
    )
    return in_order(asked, recordings.c[sort.column], recordings.c.id, sort, None)


def _lines(row: Mapping[Any, Any], units: Mapping[str, str]) -> Iterator[dict[str, Any]]:
    plain = sealed_document(row)
    shared = {
        "recording": str(UUID(bytes=row["uuid"])),
        "action": plain["action"],
        "dataset": row["dataset"],
        "object": row["name"],
        "gripper": row["gripper"],
        "recorded_at": moment_from(plain["recorded_at"]),
        "ground_truth": plain["ground_truth"],
    }
    for entry in plain["entries"]:
        yield {**shared, **counted(entry_columns(entry_from(entry)), units), "document": to_json(entry)}
