"""Devices and setups."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path
from fastapi.responses import Response

from palpate.server.api import plain
from palpate.server.api.answers import answer
from palpate.server.api.models import Device, Page, Setup
from palpate.server.api.parameters import StoreOf
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store.visible_setups import seen_devices, seen_setups

__all__ = ["router"]

router = APIRouter(tags=["devices and setups"])


@router.get("/devices", response_model=Page[Device])
def list_devices(store: StoreOf, who: Who) -> Response:
    """All devices by kind, name and date of calibration; one that was calibrated again is another one."""
    return answer({"items": [plain.device_row(one) for one in seen_devices(store, who.viewer)], "next": None})


@router.get("/setups", response_model=Page[Setup])
def list_setups(store: StoreOf, who: Who) -> Response:
    """All setups, the most used first."""
    return answer({"items": [plain.setup(one) for one in seen_setups(store, who.viewer)], "next": None})


@router.get("/setups/{digest}", response_model=Setup)
def get_setup(store: StoreOf, who: Who, digest: Annotated[str, Path(pattern="^[0-9a-f]{64}$")]) -> Response:
    """One setup."""
    found = seen_setups(store, who.viewer, bytes.fromhex(digest))
    if not found:
        raise problem(404, f"setup {digest}: there is none, or none that you may see")
    return answer(plain.setup(found[0]))
