"""Objects: a grid of them, and a page for each with all that was measured."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated
from urllib.parse import urlencode

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response

from palpate.server.api.parameters import SeenThing, StoreOf
from palpate.server.api.queries import ObjectQuery, Text
from palpate.server.corrections import may_change
from palpate.server.names import thing_address
from palpate.server.pages.colours import colours_of
from palpate.server.pages.others import Alike, alike
from palpate.server.pages.saved import saved
from palpate.server.pages.shown import Dark, Shown, figure, shown
from palpate.server.pages.templates import page
from palpate.server.plots.final_beliefs import beliefs_plot
from palpate.server.plots.plot import Plot
from palpate.server.plots.points import points_plot
from palpate.server.rest.proposals import PROPOSAL
from palpate.server.security.who import Who
from palpate.store.entries import Distribution, Value
from palpate.store.final_beliefs import FinalBelief, final_beliefs
from palpate.store.known_units import scale
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.parts import Head, head_of
from palpate.store.rows import most_probable
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_known import known_of_merged
from palpate.store.visible_results import Result, results_of
from palpate.store.visible_setups import seen_grippers, seen_properties
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
    return page(
        request,
        "objects.html",
        things=found.rows,
        cursor=found.cursor,
        asked=query,
        properties=[one.name for one in seen_properties(store, who.viewer)],
        grippers=seen_grippers(store, who.viewer),
    )


@dataclass(frozen=True)
class About:
    """What an object's page says of one property.

    Attributes
    ----------
    lines
        How many lines at values that are known to be true the plot has.
    others
        Results that are neither in the plot nor labels.
    count, true_count
        How many results there are, and how many of them are known to be true, which are lines and no points.
    """

    name: str
    plot: Shown | None
    lines: int
    labels: Sequence[tuple[str, int]]
    others: Sequence[Alike]
    others_count: int
    count: int
    true_count: int


@dataclass(frozen=True)
class Believed:
    """What explorations ended up believing of one property."""

    name: str
    plot: Shown


@router.get("/{dataset}/{name}")
def one(request: Request, store: StoreOf, who: Who, thing: SeenThing) -> HTMLResponse:
    """All that was measured of an object."""
    thing = _as_counted(store, who.viewer, thing)
    results = results_of(store, who.viewer, thing.ref)
    colours = colours_of(store, {result.measured_by for result in results})
    names = dict.fromkeys(result.property for result in results if result.property is not None)
    return page(
        request,
        "object.html",
        thing=thing,
        saved=saved(request),
        may_change=may_change(store, who, thing.ref),
        properties=[_about(name, results, thing, colours) for name in names],
        beliefs=list(_believed(store, who, thing)),
        recordings=list_recordings(store, VisibleFilter(thing=thing.path, viewer=who.viewer), limit=20),
        episodes=list_episodes(store, thing=thing.path, viewer=who.viewer, limit=10).rows,
        proposals=_proposals(store, who.viewer, thing),
    )


def _as_counted(store: Store, viewer: Viewer, thing: Thing) -> Thing:
    """An object with what is known of those that count as it, where nothing is said of it."""
    name, own = (thing.ref.dataset, thing.ref.id), {one.entry.property for one in thing.known}
    more = known_of_merged(store, viewer, [name]).get(name, ())
    return replace(thing, known=(*thing.known, *(one for one in more if one.entry.property not in own)))


def _proposals(store: Store, viewer: Viewer, thing: Thing) -> list[Head]:
    """Grasps that somebody proposes for an object, the last ones."""
    wanted = VisibleFilter(thing=thing.path, action=PROPOSAL, viewer=viewer)
    found = (head_of(store, viewer, row.id) for row in list_recordings(store, wanted, limit=PROPOSALS).rows)
    return [head for head in found if head is not None]


@router.get("/{dataset}/{name}/plot.json")
def points(store: StoreOf, who: Who, thing: SeenThing, property: Text, dark: Dark = False) -> Response:
    """The figure of all values of one property."""
    every = results_of(store, who.viewer, thing.ref)
    own = [result for result in every if result.property == property]
    colours = colours_of(store, {result.measured_by for result in every})
    return figure(_points(property, own, _as_counted(store, who.viewer, thing), colours), dark=dark)


@router.get("/{dataset}/{name}/beliefs.json")
def beliefs(store: StoreOf, who: Who, thing: SeenThing, property: Text, dark: Dark = False) -> Response:
    """The figure of what explorations ended up believing of one property."""
    found = final_beliefs(store, who.viewer, thing.ref)
    return figure(_beliefs_plot(property, found, _as_counted(store, who.viewer, thing)), dark=dark)


def _about(name: str, results: Sequence[Result], thing: Thing, colours: Mapping[str, int]) -> About:
    own = [result for result in results if result.property == name]
    labels = Counter(result.label for result in own if result.label is not None)
    points = _points(name, own, thing, colours)
    others = [one for one in own if one.label is None and (one.value is None or points is None)]
    return About(
        name,
        plot=shown(points, _figure(thing, "plot", name)),
        lines=0 if points is None else len(points.levels),
        labels=labels.most_common(),
        others=alike(others),
        others_count=len(others),
        count=len(own),
        true_count=sum(one.ground_truth for one in own),
    )


def _points(name: str, own: Sequence[Result], thing: Thing, colours: Mapping[str, int]) -> Plot | None:
    unit = next((result.unit for result in own if result.unit is not None), None)
    return points_plot(name, own, _truths(name, unit, thing), colours)


def _believed(store: StoreOf, who: Who, thing: Thing) -> Iterator[Believed]:
    found = final_beliefs(store, who.viewer, thing.ref)
    for name in dict.fromkeys(name for one in found for name in one.belief):
        plot = shown(_beliefs_plot(name, found, thing), _figure(thing, "beliefs", name))
        if plot is not None:
            yield Believed(name, plot)


def _beliefs_plot(name: str, found: Sequence[FinalBelief], thing: Thing) -> Plot | None:
    unit = next((one.belief[name].get("unit") for one in found if name in one.belief), None)
    labels = [
        most_probable(one.entry.probabilities)
        for one in thing.known
        if isinstance(one.entry, Distribution) and one.entry.property == name
    ]
    return beliefs_plot(name, found, _truths(name, unit, thing), next(iter(labels), None))


def _figure(thing: Thing, what: str, property: str) -> str:
    return f"/objects/{thing_address(thing.ref)}/{what}.json?{urlencode({'property': property})}"


def _truths(name: str, unit: object, thing: Thing) -> list[tuple[float, str]]:
    """Values that are known, in a unit; none where that is no unit of theirs, as beliefs may be in any."""
    if not isinstance(unit, str):
        return []
    return [
        (one.entry.value * by, one.source)
        for one in thing.known
        if isinstance(one.entry, Value) and one.entry.property == name and one.entry.unit is not None
        if (by := scale(one.entry.unit, unit)) is not None
    ]
