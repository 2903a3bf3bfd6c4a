"""The errors of devices against what is known: a row for each object, a mark for each device."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.errors import plural
from palpate.server.benchmark import Agreement, Cell
from palpate.server.names import thing_address
from palpate.server.plots.drawing import with_sd
from palpate.server.plots.plot import Level, Plot, Point, Row
from palpate.store.records import ThingRef

__all__ = ["errors_plot"]

ROW = 26.0
MOST_OBJECTS = 60


def errors_plot(found: Agreement, colours: Mapping[str, int], device: str | None = None) -> Plot | None:
    """The mean of each device, or of one, minus the truth, with its SD; None where no truth is known.

    `colours` has that of each device.
    """
    cells = [cell for cell in found.cells if cell.error is not None and device in (None, cell.device)]
    things = sorted({(cell.dataset, cell.thing) for cell in cells})[:MOST_OBJECTS]
    if not things:
        return None
    devices = [one.device for one in found.devices]
    rows = {thing: Row(thing[1], "", ROW * place, ROW * (place + 1)) for place, thing in enumerate(things)}
    points = [
        _point(found, cell, rows[cell.dataset, cell.thing], devices, colours)
        for cell in cells
        if (cell.dataset, cell.thing) in rows
    ]
    whose = plural(len(devices), "device") if device is None else device
    return Plot(
        title=f"errors of {whose} in {found.property} [{found.unit}]",
        across=f"measured - true {found.property} [{found.unit}]",
        rows=tuple(rows.values()),
        points=tuple(points),
        levels=(Level(0.0),),
    )


def _point(found: Agreement, cell: Cell, row: Row, devices: list[str], colours: Mapping[str, int]) -> Point:
    place = devices.index(cell.device)
    error, sd = cell.error or 0.0, cell.sd or 0.0
    # of one value no SD is known, which is not one of 0
    told = f"{cell.device}: {with_sd(error, cell.sd)} {found.unit}, n = {cell.count}"
    y = row.top + ROW * (place + 1) / (len(devices) + 1)
    link = f"/objects/{thing_address(ThingRef(cell.dataset, cell.thing))}"
    return Point(error, y, error - sd, error + sd, told, link, colours[cell.device])
