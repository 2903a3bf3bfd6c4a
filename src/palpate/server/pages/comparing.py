"""How grippers differ: the same property of the same objects, and the error of each against what is known."""

from __future__ import annotations

import csv
import io
from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import HTMLResponse, Response
from pydantic import BaseModel, ConfigDict

from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import Text
from palpate.server.benchmark import Agreement, agreements
from palpate.server.pages.shown import Dark, figure, shown
from palpate.server.pages.templates import page, search
from palpate.server.plots.errors import errors_plot
from palpate.server.security.who import Who
from palpate.store.visible_setups import seen_properties

__all__ = ["router"]

router = APIRouter(prefix="/compare")


class Asked(BaseModel):
    """Which property."""

    model_config = ConfigDict(extra="forbid")

    property: Text | None = None


@router.get("")
def compare(request: Request, store: StoreOf, who: Who, asked: Annotated[Asked, Query()]) -> HTMLResponse:
    """Compare what measured one property."""
    names = [one.name for one in seen_properties(store, who.viewer) if one.unit is not None]
    name = asked.property or next(iter(names), None)
    found = None if name is None else agreements(store, who.viewer, name)
    plot = None if found is None else shown(errors_plot(found), search("/compare/plot.json", property=name or ""))
    return page(request, "compare.html", names=names, name=name, found=found, plot=plot)


@router.get("/plot.json")
def plot(store: StoreOf, who: Who, property: Text, dark: Dark = False) -> Response:
    """The figure of the errors of devices in one property."""
    return figure(errors_plot(agreements(store, who.viewer, property)), dark=dark)


@router.get("/table.csv")
def table(store: StoreOf, who: Who, asked: Annotated[Asked, Query()]) -> Response:
    """The table of a comparison as CSV, a row for each device and object."""
    found = agreements(store, who.viewer, asked.property or "")
    headers = {"Content-Disposition": 'attachment; filename="comparison.csv"'}
    return Response(_csv(found), 200, headers, "text/csv")


def _csv(found: Agreement) -> str:
    lines = io.StringIO()
    writer = csv.writer(lines)
    writer.writerow(("device", "dataset", "object", "unit", "count", "mean", "sd", "true_value", "error"))
    for cell in found.cells:
        names = (
            f"'{text}" if text[:1] in tuple("=+-@\t\r") else text for text in (cell.device, cell.dataset, cell.thing)
        )
        writer.writerow((*names, found.unit, cell.count, cell.mean, cell.sd, cell.truth, cell.error))
    return lines.getvalue()
