"""Objects x properties, devices with their calibrations, and units of properties, in the terminal."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING

from rich.table import Table

from palpate.cli.terminal import folding_table
from palpate.wording import number

if TYPE_CHECKING:
    from palpate.store.calibrations import KnownDevice
    from palpate.store.summary import Cell
    from palpate.store.units import PropertyUnit

__all__ = ["cell_words", "cells_table", "devices_table", "units_table"]


def cells_table(cells: Sequence[Cell]) -> Table:
    """A row for each object, a column for each property."""
    names = sorted({(cell.property, cell.unit) for cell in cells})
    found = {(cell.dataset, cell.thing, cell.property): cell for cell in cells}
    table = folding_table("object", "dataset", *(f"{name} [{unit}]" for name, unit in names))
    for dataset, thing in sorted({(cell.dataset, cell.thing) for cell in cells}):
        row = [found.get((dataset, thing, name)) for name, _ in names]
        table.add_row(thing, dataset, *("" if cell is None else cell_words(cell) for cell in row))
    return table


def cell_words(cell: Cell) -> str:
    """Mean and SD, and in brackets how many values there are and how far devices differ.

    Examples
    --------
    >>> from palpate.store.summary import Cell
    >>> cell_words(Cell("ycb", "mug", "mass", "g", 118.2, 1.25, 5, 2, 0.8))
    '118 ± 1.25 (5, devices ± 0.800)'
    """
    spread = "" if cell.sd is None else f" ± {number(cell.sd)}"
    between = "" if cell.between_devices_sd is None else f", devices ± {number(cell.between_devices_sd)}"
    return f"{number(cell.mean)}{spread} ({cell.count}{between})"


def devices_table(found: Sequence[KnownDevice]) -> Table:
    """A row for each device and calibration."""
    table = folding_table("kind", "device", "maker", "calibrated on", "calibration", "recordings", right=(5,))
    for device, count in found:
        told = json.dumps(device.calibration) if device.calibration else ""
        table.add_row(
            device.kind, device.name, device.maker or "", device.calibrated_on or "not stated", told, str(count)
        )
    return table


def units_table(found: Sequence[PropertyUnit]) -> Table:
    """A row for each property."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("property", "unit", "results", "do not count"):
        table.add_column(name, overflow="fold")
    for one in found:
        table.add_row(one.name, one.unit, str(one.results), str(one.wrong or ""))
    return table
