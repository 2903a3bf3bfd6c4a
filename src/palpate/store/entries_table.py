"""Results as a tidy table: a row for each, with what it is of, from whom and when."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any
from uuid import UUID

from sqlalchemy import Connection, Select, select

from palpate.store import schema
from palpate.store.archive_rows import entries_schema
from palpate.store.chunks import chunks
from palpate.store.content import to_json
from palpate.store.decoding import entry_from, moment_from
from palpate.store.errors import DamagedError, IncompleteError
from palpate.store.fetching import read_rows
from palpate.store.filters import Filter, Sort
from palpate.store.legible import legible, reading
from palpate.store.listing import Damaged
from palpate.store.matching import in_order, matching
from palpate.store.rows import counted, entry_columns
from palpate.store.seals import recording_name, sealed_document
from palpate.store.store import Store
from palpate.store.units import deciding_units

if TYPE_CHECKING:
    import pyarrow

__all__ = ["entries_table"]

AT_ONCE = 2000
Row = Mapping[Any, Any]


def entries_table(
    store: Store,
    wanted: Filter | None = None,
    sort: Sort | None = None,
    *,
    limit: int | None = None,
    damaged: Damaged | None = None,
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
    damaged
        Is told of each recording that is not what was written, and the table has none of it; unless given, the first
        one is raised.

    Raises
    ------
    DamagedError
        If a recording is not what was written.
    """
    import pyarrow

    columns = entries_schema()
    with reading(store.engine) as connection:
        units, batches = deciding_units(connection), []
        ids = connection.scalars(_ids_asked(wanted or Filter(), sort or Sort(), limit)).all()
        for some in chunks(ids, AT_ONCE):
            rows = _rows(connection, some)
            lines = [line for row in rows for line in _whole(row, units, damaged)]
            batches.append(pyarrow.RecordBatch.from_pylist(lines, schema=columns))
    return pyarrow.Table.from_batches(batches, schema=columns)


def _ids_asked(wanted: Filter, sort: Sort, limit: int | None) -> Select[int]:
    recordings = schema.recordings.c
    those = matching(wanted, sort, None, limit).subquery()
    asked = select(recordings.id).join(those, those.c.id == recordings.id)
    return in_order(asked, recordings[sort.column], recordings.id, sort, None)


def _rows(connection: Connection, ids: Sequence[int]) -> list[Row | DamagedError]:
    """The rows of these numbers in order, or what is wrong with a cell of one."""
    recordings, things = schema.recordings, schema.things
    names = ("id", "uuid", "digest", "gripper", "document", "seal")
    asked = select(*(recordings.c[name] for name in names), things.c.dataset, things.c.name)
    # one whose object is missing is told, and not left out
    asked = asked.outerjoin(things, things.c.id == recordings.c.thing_id)
    try:
        found = {row["id"]: row for row in connection.execute(asked.where(recordings.c.id.in_(ids))).mappings()}
        return [found[row] for row in ids]
    except IncompleteError:
        raise
    except DamagedError:
        # one of them: look at each alone, to name it
        return list(read_rows(connection, asked, ids))


def _whole(row: Row | DamagedError, units: Mapping[str, str], damaged: Damaged | None) -> Sequence[dict[str, Any]]:
    """The results of a row that is what was written; what is not is told, or raised."""
    try:
        if isinstance(row, DamagedError):
            raise row
        plain = sealed_document(row)
        with legible(recording_name(row["uuid"])):
            return list(_lines(row, plain, units))
    except DamagedError as error:
        if damaged is None:
            raise
        damaged(error)
        return []


def _lines(row: Row, plain: Mapping[str, Any], units: Mapping[str, str]) -> Iterator[dict[str, Any]]:
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
