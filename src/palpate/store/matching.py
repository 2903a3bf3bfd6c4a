"""Which recordings match, in the order of a list, as the database is asked."""

from __future__ import annotations

from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, Select, and_, exists, select, tuple_

from palpate.store import schema
from palpate.store.filters import Filter, Sort
from palpate.store.legible import reading
from palpate.store.page_ends import PageEnd
from palpate.store.store import Store

__all__ = ["ids_matching", "in_order", "matching"]


def ids_matching(store: Store, wanted: Filter, sort: Sort | None = None) -> list[UUID]:
    """Ids of all recordings that match, in order."""
    sort = sort or Sort()
    found = matching(wanted, sort, None, None).subquery()
    columns = schema.recordings.c
    asked = select(columns.uuid).join(found, found.c.id == columns.id)
    with reading(store.engine) as connection:
        rows = connection.scalars(in_order(asked, columns[sort.column], columns.id, sort, None))
        return [UUID(bytes=uuid) for uuid in rows]


def matching(wanted: Filter, sort: Sort, after: PageEnd | None, limit: int | None) -> Select[*tuple[Any, ...]]:
    """Row numbers of the recordings that match, in order.

    Where entries are asked for and the sorting allows, an index over entries gives the rows in order, so that neither
    a common nor a rare property makes the database read more than a page.
    """
    entries = wanted.entry_conditions()
    if entries and sort.by == "recorded":
        asked = _from_entries(wanted, entries, sort, after)
    else:
        columns = schema.recordings.c
        asked = select(columns.id, columns[sort.column])
        asked = asked.where(*wanted.conditions(), *(_has_entry(columns.id, *entry) for entry in entries))
        asked = in_order(asked, columns[sort.column], columns.id, sort, after)
    return asked if limit is None else asked.limit(limit)


def _from_entries(
    wanted: Filter, entries: list[tuple[str, str | None]], sort: Sort, after: PageEnd | None
) -> Select[*tuple[Any, ...]]:
    columns = schema.entries.c
    (name, label), *others = entries
    asked = select(columns.recording_id.label("id"), columns.recorded_us).where(columns.property == name).distinct()
    if label is not None:
        asked = asked.where(columns.label == label)
    if wanted.gripper is not None:
        asked = asked.where(columns.gripper == wanted.gripper)
    asked = asked.where(*(_has_entry(columns.recording_id, *other) for other in others))
    conditions = list(wanted.conditions())
    # the index over entries knows the gripper already
    if len(conditions) > (wanted.gripper is not None):
        asked = asked.join(schema.recordings, schema.recordings.c.id == columns.recording_id).where(*conditions)
    return in_order(asked, columns.recorded_us, columns.recording_id, sort, after)


def in_order(
    asked: Select[*tuple[Any, ...]],
    value: ColumnElement[Any],
    row: ColumnElement[int],
    sort: Sort,
    after: PageEnd | None,
) -> Select[*tuple[Any, ...]]:
    """What was asked in the order of a sorting, which a column and the row number make unique, after a page."""
    if after is not None:
        place, end = tuple_(value, row), tuple_(after.value, after.row)
        asked = asked.where(place < end if sort.descending else place > end)
    return asked.order_by(value.desc(), row.desc()) if sort.descending else asked.order_by(value, row)


def _has_entry(recording: ColumnElement[int], name: str, label: str | None) -> ColumnElement[bool]:
    other = schema.entries.alias()
    condition = and_(other.c.recording_id == recording, other.c.property == name)
    return exists().where(condition if label is None else and_(condition, other.c.label == label))
