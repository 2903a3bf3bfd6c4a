"""Devices with their calibrations, and setups."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path, Request
from fastapi.responses import HTMLResponse

from palpate.server.api.parameters import StoreOf
from palpate.server.pages.templates import page
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store.listing import list_recordings
from palpate.store.viewing import VisibleFilter
from palpate.store.visible_setups import seen_devices, seen_setups

__all__ = ["router"]

router = APIRouter()


@router.get("/devices")
def devices(request: Request, store: StoreOf, who: Who) -> HTMLResponse:
    """All devices."""
    return page(request, "devices.html", devices=seen_devices(store, who.viewer))


@router.get("/setups/{digest}")
def setup(
    request: Request, store: StoreOf, who: Who, digest: Annotated[str, Path(pattern="^[0-9a-f]{64}$")]
) -> HTMLResponse:
    """One setup."""
    found = seen_setups(store, who.viewer, bytes.fromhex(digest))
    if not found:
        raise problem(404, f"setup {digest}: there is none, or none that you may see")
    recordings = list_recordings(store, VisibleFilter(setup=digest, viewer=who.viewer), limit=20)
    return page(request, "setup.html", found=found[0], recordings=recordings.rows)
