"""Lists of recordings: filtered, sorted, in pages."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from functools import cache
from typing import TYPE_CHECKING, Any
from uuid import UUID

from sqlalchemy import Connection, Select, select

from palpate.store import schema
from palpate.store.content import entry_plain, to_json
from palpate.store.decoding import entry_from, moment_from
from palpate.store.embargo import embargo_of
from palpate.store.entries import Entry
from palpate.store.errors import DamagedError, IncompleteError
from palpate.store.fetching import read_rows
from palpate.store.filters import Filter, Sort
from palpate.store.legible import legible, reading
from palpate.store.matching import in_order, matching
from palpate.store.page_ends import Lists, PageEnd
from palpate.store.rows import moment_at
from palpate.store.seals import Named, sealed_document
from palpate.store.store import Store
from palpate.store.upload_order import settled
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_words import seen_names

if TYPE_CHECKING:
    import pyarrow

__all__ = ["Damaged", "Listed", "Page", "list_recordings", "to_arrow"]

AS_THEY_COME = Sort("uploaded", descending=False)
Damaged = Callable[[DamagedError], None]
"""Is told of what is left out because it is not what was written."""


@dataclass(frozen=True)
class Listed:
    """A recording as it stands in a list."""

    id: UUID
    digest: str
    recorded_at: datetime
    uploaded_at: datetime
    action: str
    dataset: str
    thing: str
    common_name: str | None
    gripper: str | None
    owner: str | None
    visibility: str
    embargoed_until: datetime | None
    ground_truth: bool
    entries: tuple[Entry, ...]
    notices: tuple[str, ...]


@dataclass(frozen=True)
class Page:
    """Some rows of a list, and the cursor that the next page begins after; None where there is none."""

    rows: tuple[Listed, ...]
    cursor: str | None


def list_recordings(
    store: Store,
    wanted: Filter | None = None,
    sort: Sort | None = None,
    *,
    limit: int = 50,
    cursor: str | None = None,
    damaged: Damaged | None = None,
) -> Page:
    """List recordings, a page at a time: what is added meanwhile neither repeats nor hides a row.

    In the order in which they were uploaded, the first one first, a recording is listed once none can come in front of
    it: while a slower upload that began before is being kept, later ones wait for it here.

    Each row is verified by its seal, see `palpate.store.seals`.

    Parameters
    ----------
    store
        Where to look.
    wanted, sort
        Which recordings, and in which order; all, the last recorded first, unless given.
    limit
        Rows of a page.
    cursor
        That of the page before.
    damaged
        Is told of each recording that is not what was written, and the page has none of it; unless given, the first
        one is raised.

    Raises
    ------
    StoreError
        If the cursor is not of a list sorted like this.
    DamagedError
        If a recording is not what was written.
    """
    sort = sort or Sort()
    viewer = wanted.viewer if isinstance(wanted, VisibleFilter) else Viewer(everything=True)
    lists = Lists(schema.recordings, sort, sort.column, viewer)
    with reading(store.engine) as connection:
        after = None if cursor is None else lists.end_at(connection, cursor)
        matched = matching(wanted or Filter(), sort, after, limit)
        if sort == AS_THEY_COME and (last := settled(connection)) is not None:
            matched = matched.where(schema.recordings.c.id <= last)
        ends, rows = _ends_and_rows(connection, matched, sort)
        names = _names(connection, rows, viewer)
        listed = tuple(_whole(rows, names, damaged))
    return Page(listed, lists.cursor_after(ends[-1], rows[-1]) if len(ends) == limit and ends else None)


def _ends_and_rows(
    connection: Connection, matched: Select[*tuple[Any, ...]], sort: Sort
) -> tuple[list[PageEnd], Sequence[Mapping[Any, Any] | DamagedError]]:
    """Where a page would end that ends with each recording that matched, and its row, or what is wrong with it."""
    asked = in_order(_rows_asked(matched), schema.recordings.c[sort.column], schema.recordings.c.id, sort, None)
    try:
        rows = connection.execute(asked).mappings().all()
    except IncompleteError:
        raise
    except DamagedError:
        # one of them: look at each alone, to name it
        ends = [PageEnd(value=row[1], row=row[0]) for row in connection.execute(matched)]
        return ends, list(read_rows(connection, _rows_asked(None), [end.row for end in ends]))
    return [PageEnd(row[sort.column], row["id"]) for row in rows], rows


def _rows_asked(matched: Select[*tuple[Any, ...]] | None) -> Select[*tuple[Any, ...]]:
    """What stands in a list of the recordings that matched; of all, unless given."""
    recordings, things = schema.recordings, schema.things
    asked = _columns()
    if matched is not None:
        page = matched.subquery()
        asked = asked.join(page, page.c.id == recordings.c.id)
    # one whose object is missing is told, and not left out
    return asked.outerjoin(things, things.c.id == recordings.c.thing_id)


@cache
def _columns() -> Select[*tuple[Any, ...]]:
    """What a list needs of recordings and their objects, worked out once."""
    recordings, things = schema.recordings, schema.things
    names = (
        "id",
        "uuid",
        "thing_id",
        "digest",
        "recorded_us",
        "uploaded_us",
        "action",
        "gripper",
        "owner",
        "visibility",
    )
    columns = [recordings.c[name] for name in (*names, "embargoed_us", "ground_truth", "document", "seal")]
    thing = [things.c.dataset, things.c.name, things.c.common_name]
    return select(*columns, *thing).select_from(recordings)


def _names(
    connection: Connection, rows: Iterable[Mapping[Any, Any] | DamagedError], viewer: Viewer
) -> Mapping[int, str | None]:
    """Common names of the objects, those that may be seen where somebody looks."""
    names = {row["thing_id"]: row["common_name"] for row in rows if not isinstance(row, DamagedError)}
    return seen_names(connection, viewer, names)


def _whole(
    rows: Iterable[Mapping[Any, Any] | DamagedError], names: Mapping[int, str | None], damaged: Damaged | None
) -> Iterator[Listed]:
    """The rows that are what was written; what is not is told, or raised."""
    for row in rows:
        try:
            if isinstance(row, DamagedError):
                raise row
            yield _listed(row, names[row["thing_id"]])
        except DamagedError as error:
            if damaged is None:
                raise
            damaged(error)


def _listed(row: Mapping[Any, Any], common_name: str | None) -> Listed:
    plain = sealed_document(row)
    with legible(Named(row["uuid"])):
        return Listed(
            id=UUID(bytes=row["uuid"]),
            digest=row["digest"].hex(),
            recorded_at=moment_from(plain["recorded_at"]),
            uploaded_at=moment_at(row["uploaded_us"]),
            dataset=row["dataset"],
            thing=row["name"],
            entries=tuple(entry_from(entry) for entry in plain["entries"]),
            notices=tuple(plain["notices"]),
            embargoed_until=embargo_of(row["embargoed_us"]),
            common_name=common_name,
            **{name: plain[name] for name in ("action", "owner", "ground_truth")},
            **{name: row[name] for name in ("gripper", "visibility")},
        )


def to_arrow(page: Page) -> pyarrow.Table:
    """The rows as an Arrow table, one row for each recording, entries as JSON; pandas and Polars read it as it is.

    ``to_arrow(page).to_pandas()`` and ``polars.from_arrow(to_arrow(page))`` give data frames.
    """
    import pyarrow

    return pyarrow.Table.from_pylist([_flat(row) for row in page.rows])


def _flat(row: Listed) -> dict[str, Any]:
    plain = {**vars(row), "id": str(row.id), "notices": list(row.notices)}
    return {**plain, "entries": [to_json(entry_plain(entry)) for entry in row.entries]}
