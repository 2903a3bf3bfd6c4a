"""The forms of setups and their devices."""

from __future__ import annotations

from typing import Any

from palpate.server.api.models.basics import Strict

__all__ = ["Device", "Setup"]


class DevicePart(Strict):
    """A device as part of a setup."""

    kind: str
    name: str
    maker: str | None
    calibrated_on: str | None
    parameters: dict[str, Any]
    calibration: dict[str, Any]


class Device(DevicePart):
    """A device as it was when it measured."""

    digest: str
    setups: list[str]
    recordings: int


class Setup(Strict):
    """Devices that measured together."""

    digest: str
    devices: list[DevicePart]
    recordings: int
