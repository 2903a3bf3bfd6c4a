"""Objects: a grid of them, and a page for each with all that was measured."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse
from markupsafe import Markup

from palpate.network.units import unit_of
from palpate.server.api.parameters import SeenThing, StoreOf
from palpate.server.api.queries import ObjectQuery
from palpate.server.corrections import may_change
from palpate.server.pages.templates import page
from palpate.server.plots.points import points_plot
from palpate.server.rest.proposals import PROPOSAL
from palpate.server.security.who import Who
from palpate.store.entries import Value
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.parts import Head, head_of
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_results import Result, results_of
from palpate.store.visible_setups import seen_properties, seen_setups
from palpate.store.visible_things import list_visible_things

__all__ = ["router"]

router = APIRouter(prefix="/objects")
CARDS = 24
PROPOSALS = 10


@router.get("")
def grid(request: Request, store: StoreOf, who: Who, query: Annotated[ObjectQuery, Query()]) -> HTMLResponse:
    """A grid of objects, searched and filtered."""
    limit = query.limit if "limit" in request.query_params else CARDS
    found = list_visible_things(store, who.viewer, query.filter(), limit=limit, cursor=query.cursor)
    setups = seen_setups(store, who.viewer)
    grippers = {one.setup.gripper.name for one in setups if one.setup.gripper is not None}
    return page(
        request,
        "objects.html",
        things=found.rows,
        cursor=found.cursor,
        asked=query,
        properties=[one.name for one in seen_properties(store, who.viewer)],
        grippers=sorted(grippers),
    )


@dataclass(frozen=True)
class About:
    """What an object's page says of one property."""

    name: str
    plot: Markup | None
    labels: Sequence[tuple[str, int]]
    others: Sequence[Result]
    count: int


@router.get("/{dataset}/{name}")
def one(request: Request, store: StoreOf, who: Who, thing: SeenThing) -> HTMLResponse:
    """All that was measured of an object."""
    results = results_of(store, who.viewer, thing.ref)
    names = dict.fromkeys(result.property for result in results if result.property is not None)
    return page(
        request,
        "object.html",
        thing=thing,
        may_change=may_change(store, who, thing.ref),
        properties=[_about(name, results, thing) for name in names],
        recordings=list_recordings(store, VisibleFilter(thing=thing.path, viewer=who.viewer), limit=20),
        episodes=list_episodes(store, thing=thing.path, viewer=who.viewer, limit=10).rows,
        proposals=_proposals(store, who.viewer, thing),
    )


def _proposals(store: Store, viewer: Viewer, thing: Thing) -> list[Head]:
    """Grasps that somebody proposes for an object, the last ones."""
    wanted = VisibleFilter(thing=thing.path, action=PROPOSAL, viewer=viewer)
    found = (head_of(store, viewer, row.id) for row in list_recordings(store, wanted, limit=PROPOSALS).rows)
    return [head for head in found if head is not None]


def _about(name: str, results: Sequence[Result], thing: Thing) -> About:
    own = [result for result in results if result.property == name]
    unit = next((result.unit for result in own if result.unit is not None), None)
    labels = Counter(result.label for result in own if result.label is not None)
    others = [result for result in own if result.value is None and result.label is None]
    return About(name, points_plot(name, own, _truths(name, unit, thing)), labels.most_common(), others, len(own))


def _truths(name: str, unit: str | None, thing: Thing) -> list[tuple[float, str]]:
    """Values that are known, in a unit."""
    if unit is None:
        return []
    known = [(one.entry, one.source) for one in thing.known if isinstance(one.entry, Value)]
    return [
        (entry.value * unit_of(entry.unit).factor / unit_of(unit).factor, source)
        for entry, source in known
        if entry.property == name and entry.unit is not None
    ]
