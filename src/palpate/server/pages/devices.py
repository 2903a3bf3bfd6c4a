"""Devices with their calibrations, and setups."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated

from fastapi import APIRouter, Path, Request
from fastapi.responses import HTMLResponse, Response

from palpate.server.api.parameters import StoreOf
from palpate.server.api.queries import Text
from palpate.server.benchmark import DeviceError, agreements, agreements_with_truth
from palpate.server.pages.colours import colours_of
from palpate.server.pages.shown import Dark, Shown, figure, shown
from palpate.server.pages.templates import page, search
from palpate.server.plots.device_colours import device_colours
from palpate.server.plots.errors import errors_plot
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store.device_order import device_names
from palpate.store.listing import list_recordings
from palpate.store.store import Store
from palpate.store.viewing import Viewer, VisibleFilter
from palpate.store.visible_setups import SeenDevice, seen_devices, seen_setups

__all__ = ["router"]

router = APIRouter()
MOST_PLOTS = 20
"""Properties of which the errors are drawn; those of the others are in the table."""
Digest = Annotated[str, Path(pattern="^[0-9a-f]{64}$")]


@router.get("/devices")
def devices(request: Request, store: StoreOf, who: Who) -> HTMLResponse:
    """All devices."""
    return page(request, "devices.html", devices=seen_devices(store, who.viewer))


@dataclass(frozen=True)
class Errors:
    """How far a device is from what is known in one property."""

    property: str
    unit: str
    error: DeviceError
    plot: Shown | None


@router.get("/devices/{digest}")
def device(request: Request, store: StoreOf, who: Who, digest: Digest) -> HTMLResponse:
    """One device: its calibration, those before and after it, and its errors."""
    found, others = _device(store, who.viewer, digest)
    return page(request, "device.html", found=found, others=others, errors=list(_errors(store, who.viewer, found)))


@router.get("/devices/{digest}/errors.json")
def errors(store: StoreOf, who: Who, digest: Digest, property: Text, dark: Dark = False) -> Response:
    """The figure of the errors of a device in one property."""
    found, _ = _device(store, who.viewer, digest)
    compared = agreements(store, who.viewer, property)
    colours = colours_of(store, {one.device for one in compared.devices})
    return figure(errors_plot(compared, colours, found.device.name), dark=dark)


@router.get("/setups/{digest}")
def setup(request: Request, store: StoreOf, who: Who, digest: Digest) -> HTMLResponse:
    """One setup."""
    found = seen_setups(store, who.viewer, bytes.fromhex(digest))
    if not found:
        raise problem(404, f"setup {digest}: there is none, or none that you may see")
    recordings = list_recordings(store, VisibleFilter(setup=digest, viewer=who.viewer), limit=20)
    parts = [one for one in seen_devices(store, who.viewer) if digest in one.setups]
    return page(request, "setup.html", found=found[0], recordings=recordings.rows, devices=parts)


def _device(store: Store, viewer: Viewer, digest: str) -> tuple[SeenDevice, list[SeenDevice]]:
    """The device of a digest, and all of its kind and name, which are its calibrations."""
    every = seen_devices(store, viewer)
    found = next((one for one in every if one.digest == digest), None)
    if found is None:
        raise problem(404, f"device {digest}: there is none, or none that you may see")
    named = (found.device.kind, found.device.name)
    return found, [one for one in every if (one.device.kind, one.device.name) == named]


def _errors(store: Store, viewer: Viewer, found: SeenDevice) -> Iterator[Errors]:
    """In each property of which a true value is known; by the name, so that all calibrations count."""
    drawn, order = 0, device_names(store)
    for compared in agreements_with_truth(store, viewer):
        for error in compared.devices:
            if error.device == found.device.name and (error.known or error.left_out):
                address = search(f"/devices/{found.digest}/errors.json", property=compared.property)
                colours = device_colours(order, {one.device for one in compared.devices})
                drawing = errors_plot(compared, colours, error.device) if drawn < MOST_PLOTS else None
                plot = shown(drawing, address)
                drawn += plot is not None
                yield Errors(compared.property, compared.unit, error, plot)
