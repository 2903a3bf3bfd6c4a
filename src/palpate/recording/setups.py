"""Setups from TOML files: the devices that measure.

A table for each of ``arm``, ``gripper``, ``camera`` and ``microphone``, any number of ``[[other]]``; each has a
``name``, and may have a ``maker``, ``parameters``, a ``calibration`` and the date ``calibrated_on``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from datetime import date
from pathlib import Path
from typing import Any

from palpate.errors import choices, near
from palpate.recording.errors import RecordingError
from palpate.store.records import DEVICE_KINDS, Device, Setup

__all__ = ["read_setup"]

KEYS = ("name", "maker", "parameters", "calibration", "calibrated_on")


def read_setup(path: str | Path) -> Setup:
    """Read a setup.

    Raises
    ------
    RecordingError
        If the file cannot be read, or a key is missing, unknown or holds something else.
    """
    try:
        content = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise RecordingError(f"{path}: is no readable TOML: {error}") from error
    for kind in content:
        if kind not in DEVICE_KINDS:
            raise RecordingError(f"{path}: {kind!r}{near(kind, DEVICE_KINDS)} is no device; {choices(DEVICE_KINDS)}")
    others = content.pop("other", [])
    if not isinstance(others, list):
        raise RecordingError(f"{path}: other is one table, expected [[other]]")
    named = {kind: _device(f"{path}: {kind}", kind, table) for kind, table in content.items()}
    return Setup(**named, other=tuple(_device(f"{path}: other", "other", table) for table in others))


def _device(where: str, kind: str, table: Any) -> Device:
    if not isinstance(table, Mapping) or not isinstance(table.get("name"), str):
        raise RecordingError(f'{where}: has no name, expected a table with name = "..."')
    for key in table:
        if key not in KEYS:
            raise RecordingError(f"{where}.{key}{near(key, KEYS)}: is no key of a device; {choices(KEYS)}")
    values = dict(table)
    # TOML has dates, and the store keeps text
    if isinstance(values.get("calibrated_on"), date):
        values["calibrated_on"] = values["calibrated_on"].isoformat()
    return Device(kind=kind, **values)
