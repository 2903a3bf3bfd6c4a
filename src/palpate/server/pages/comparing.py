"""How grippers differ: the same property of the same objects, and the error of each against what is known."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from typing import Annotated
from uuid import UUID

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response
from pydantic import BaseModel, ConfigDict

from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import Text
from palpate.server.api.series import cell_text
from palpate.server.benchmark import Cell, agreements
from palpate.server.memory import Memory
from palpate.server.pages.allowance import MOST_NUMBERS
from palpate.server.pages.colours import colours_of
from palpate.server.pages.overlays import Choice, choices_of, laid_over
from palpate.server.pages.shown import Dark, figure, shown
from palpate.server.pages.templates import page, search
from palpate.server.plots.errors import errors_plot
from palpate.server.security.who import Who
from palpate.store.records import ThingRef
from palpate.store.visible_results import results_of
from palpate.store.visible_setups import seen_properties

__all__ = ["router"]

router = APIRouter(prefix="/compare")


class Asked(BaseModel):
    """Which property; which object, as data set and name with a slash between; which recordings of it.

    `chosen` is there where somebody had the choice: a form tells nothing of boxes that are off.
    """

    model_config = ConfigDict(extra="forbid")

    property: Text | None = None
    object: Text | None = None
    recording: list[UUID] = []
    chosen: bool = False


@router.get("")
def compare(
    request: Request, store: StoreOf, who: Who, memory: Memory, asked: Annotated[Asked, Query()]
) -> HTMLResponse:
    """Compare what measured one property, of all objects or of one."""
    names = [one.name for one in seen_properties(store, who.viewer) if one.unit is not None]
    name = asked.property or next(iter(names), None)
    found = None if name is None else agreements(store, who.viewer, name)
    things = {} if found is None else {"/".join(cell.key): cell.key for cell in found.cells}
    thing = things.get(asked.object or "")
    own = (
        []
        if thing is None
        else [one for one in results_of(store, who.viewer, ThingRef(*thing)) if one.property == name]
    )
    devices = {one.measured_by for one in own} | {one.device for one in (found.devices if found else ())}
    colours = colours_of(store, devices)
    choices = choices_of(own, asked.recording, colours)
    chosen = {one.recording: one.colour for one in choices if one.colour is not None}
    laid = laid_over(store, who.viewer, memory, chosen) if chosen else None
    return page(
        request,
        "compare.html",
        names=names,
        name=name,
        found=found,
        things=sorted(things),
        thing=thing,
        asked=asked,
        choices=choices,
        missing=_missing(asked.recording, choices),
        not_drawn=sum(one.ticked and one.colour is None for one in choices),
        laid=laid,
        most_numbers=MOST_NUMBERS,
        colours=colours,
        plot=None
        if found is None
        else shown(errors_plot(found, colours), search("/compare/plot.json", property=name or "")),
    )


def _missing(asked: Sequence[UUID], choices: Sequence[Choice]) -> list[UUID]:
    """Recordings that are not among the choices, each once."""
    there = {one.recording for one in choices}
    return [key for key in dict.fromkeys(asked) if key not in there]


@router.get("/plot.json")
def plot(store: StoreOf, who: Who, property: Text, dark: Dark = False) -> Response:
    """The figure of the errors of devices in one property."""
    found = agreements(store, who.viewer, property)
    return figure(errors_plot(found, colours_of(store, {one.device for one in found.devices})), dark=dark)


@router.get("/table.csv")
def table(store: StoreOf, who: Who, property: Text = "", object: Text | None = None) -> Response:
    """The table of a comparison as CSV, a row for each device and object; of one object where one is asked for."""
    headers = {"Content-Disposition": 'attachment; filename="comparison.csv"'}
    found = agreements(store, who.viewer, property)
    cells = [cell for cell in found.cells if object in (None, "/".join(cell.key))]
    return Response(_csv(cells, found.unit), 200, headers, "text/csv")


def _csv(cells: Sequence[Cell], unit: str | None) -> str:
    lines = io.StringIO()
    writer = csv.writer(lines)
    writer.writerow(
        ("device", "dataset", "object", "unit", "count", "bounds_only", "mean", "sd", "true_value", "error")
    )
    for cell in cells:
        names = map(cell_text, (cell.device, cell.dataset, cell.thing))
        writer.writerow((*names, unit, cell.count, cell.censored, cell.mean, cell.sd, cell.truth, cell.error))
    return lines.getvalue()
