"""Results and properties."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Annotated, Any

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from palpate.server.api import plain
from palpate.server.api.answers import answer, page
from palpate.server.api.models import EntryRow, Page, Property
from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import RecordingQuery
from palpate.server.security.who import Who
from palpate.store.listing import Listed, list_recordings
from palpate.store.rows import entry_columns
from palpate.store.visible_setups import result_counts, seen_properties

__all__ = ["router"]

router = APIRouter(tags=["results"])


@router.get("/entries", response_model=Page[EntryRow])
def list_entries(request: Request, store: StoreOf, who: Who, query: Annotated[RecordingQuery, Query()]) -> Response:
    """Results, a row for each; `limit` counts recordings, so that a page may have more rows or fewer.

    Where a property is asked for, only results of it are there.
    """
    wanted, sort = query.filter(who.viewer), query.sorting()
    found = list_recordings(store, wanted, sort, limit=query.limit, cursor=query.cursor)
    return page(request, query, (one for row in found.rows for one in _rows(row, query.property)), found.cursor)


@router.get("/properties", response_model=Page[Property])
def list_properties(store: StoreOf, who: Who) -> Response:
    """All properties that were measured, with the unit that each was first given in."""
    counts = result_counts(store, who.viewer)
    found = ({**vars(one), "entries": counts.get(one.name, 0)} for one in seen_properties(store, who.viewer))
    return answer({"items": list(found), "next": None})


def _rows(row: Listed, wanted: str | None) -> Iterator[dict[str, Any]]:
    for entry in row.entries:
        if wanted is not None and entry.property != wanted:
            continue
        columns = entry_columns(entry)
        yield {
            "recording": str(row.id),
            "recorded_at": plain.moment(row.recorded_at),
            "action": row.action,
            "object": {"dataset": row.dataset, "name": row.thing},
            "gripper": row.gripper,
            "ground_truth": bool(row.ground_truth),
            **{name: columns[name] for name in ("label", "value_si", "sd_si")},
            "entry": plain.entry(entry),
        }
