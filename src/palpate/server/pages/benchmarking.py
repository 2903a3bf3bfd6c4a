"""The benchmark: the error of each device in each property against what is known, to read and to download."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Iterator
from dataclasses import asdict
from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse, JSONResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.api.series import cell_text
from palpate.server.benchmark import Agreement, DeviceError, agreements_with_truth
from palpate.server.pages.templates import page
from palpate.server.security.who import Who
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["errors_of", "router"]

router = APIRouter(prefix="/benchmark")
COLUMNS = (
    "property",
    "unit",
    "device",
    "objects",
    "values",
    "bounds_only",
    "known",
    "left_out",
    "bias",
    "sd",
    "rms",
    "low",
    "high",
)


def errors_of(store: Store, viewer: Viewer) -> Iterator[tuple[str, str, DeviceError]]:
    """Property, unit, and the error of a device in it, of all that somebody may see and of which a truth is known."""
    yield from _errors(agreements_with_truth(store, viewer))


def _errors(agreements: Iterable[Agreement]) -> Iterator[tuple[str, str, DeviceError]]:
    for found in agreements:
        yield from ((found.property, found.unit, error) for error in found.devices if error.known or error.left_out)


@router.get("")
def table(request: Request, store: StoreOf, who: Who) -> HTMLResponse:
    """All devices in all properties."""
    found = agreements_with_truth(store, who.viewer)
    unknown = [f"{one.property} [{unit}]" for one in found for unit in one.unknown_units]
    return page(request, "benchmark.html", rows=list(_errors(found)), unknown=unknown)


@router.get("/errors.csv")
def as_csv(store: StoreOf, who: Who) -> Response:
    """The same as CSV."""
    lines = io.StringIO()
    writer = csv.DictWriter(lines, COLUMNS)
    writer.writeheader()
    for row in (_row(*one) for one in errors_of(store, who.viewer)):
        writer.writerow({name: cell_text(value) if isinstance(value, str) else value for name, value in row.items()})
    headers = {"Content-Disposition": 'attachment; filename="benchmark.csv"'}
    return Response(lines.getvalue(), 200, headers, "text/csv")


@router.get("/errors.json")
def as_json(store: StoreOf, who: Who) -> JSONResponse:
    """The same as JSON."""
    return JSONResponse({"items": [_row(*one) for one in errors_of(store, who.viewer)]})


def _row(property: str, unit: str, error: DeviceError) -> dict[str, Any]:
    low, high = error.interval or (None, None)
    told = {
        **asdict(error),
        "property": property,
        "unit": unit,
        "bounds_only": error.censored,
        "low": low,
        "high": high,
    }
    return {name: told[name] for name in COLUMNS}
