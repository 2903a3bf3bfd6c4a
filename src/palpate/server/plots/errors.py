"""The errors of devices against what is known: a row for each object, a mark for each device."""

from __future__ import annotations

from markupsafe import Markup

from palpate.server.benchmark import Agreement
from palpate.server.names import thing_address
from palpate.server.plots.drawing import COLOURS, Drawing, number
from palpate.server.plots.scale import spanning
from palpate.store.records import ThingRef

__all__ = ["errors_plot"]

WIDTH, LEFT, RIGHT = 760.0, 200.0, 16.0
TOP, ROW, BOTTOM = 12.0, 26.0, 44.0
MOST_OBJECTS = 60


def errors_plot(found: Agreement) -> Markup | None:
    """Draw the mean of each device minus the truth, with its SD; None where no truth is known."""
    cells = [cell for cell in found.cells if cell.error is not None]
    things = sorted({(cell.dataset, cell.thing) for cell in cells})[:MOST_OBJECTS]
    if not things:
        return None
    devices = [one.device for one in found.devices]
    height = ROW * len(things)
    drawing = Drawing(
        WIDTH, TOP + height + BOTTOM, f"errors of {len(devices)} devices in {found.property} [{found.unit}]"
    )
    ends = [end for cell in cells for end in ((cell.error or 0) - (cell.sd or 0), (cell.error or 0) + (cell.sd or 0))]
    across = spanning([0.0, *ends], LEFT, WIDTH - RIGHT)
    drawing.across_axis(across, TOP, TOP + height, f"measured - true {found.property} [{found.unit}]")
    drawing.line(across.at(0.0), TOP, across.at(0.0), TOP + height, "truth")
    for row, (dataset, thing) in enumerate(things):
        top = TOP + row * ROW
        drawing.text(LEFT - 10, top + ROW / 2 + 4, thing[:26], "name", "end")
        drawing.line(LEFT, top + ROW, WIDTH - RIGHT, top + ROW, "grid")
        own = [cell for cell in cells if (cell.dataset, cell.thing) == (dataset, thing)]
        for cell in own:
            place = devices.index(cell.device)
            y = round(top + ROW * (place + 1) / (len(devices) + 1), 2)
            error, sd = cell.error or 0.0, cell.sd or 0.0
            drawing.line(across.at(error - sd), y, across.at(error + sd), y, f"bar c{place % COLOURS}")
            told = f"{cell.device}: {number(error)} ± {number(sd)} {found.unit}, n = {cell.count}"
            link = f"/objects/{thing_address(ThingRef(dataset, thing))}"
            drawing.dot(across.at(error), y, f"c{place % COLOURS}", told, link)
    return drawing.markup()
