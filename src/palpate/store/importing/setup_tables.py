"""Setups from the tables of a TOML file: the devices that measure.

A table for each of ``arm``, ``gripper``, ``camera`` and ``microphone``, any number of ``[[other]]``; each has a
``name``, and may have a ``maker``, ``parameters``, a ``calibration`` and the date ``calibrated_on``.
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import date
from typing import Any

from palpate.errors import choices, near
from palpate.store.errors import StoreError
from palpate.store.records import DEVICE_KINDS, Device, Setup

__all__ = ["setup_from_tables"]

KEYS = ("name", "maker", "parameters", "calibration", "calibrated_on")


def setup_from_tables(tables: Mapping[str, Any], where: str) -> Setup:
    """Read a setup.

    Raises
    ------
    StoreError
        If a key is missing, unknown or holds something else; `where` begins the message.

    Examples
    --------
    >>> setup_from_tables({"gripper": {"name": "claw"}}, "setup.toml").gripper.name
    'claw'
    """
    for kind in tables:
        if kind not in DEVICE_KINDS:
            raise StoreError(f"{where}: {kind!r}{near(kind, DEVICE_KINDS)} is no device; {choices(DEVICE_KINDS)}")
    others = tables.get("other", [])
    if not isinstance(others, list):
        raise StoreError(f"{where}: other is one table, expected [[other]]")
    named = {kind: _device(f"{where}: {kind}", kind, table) for kind, table in tables.items() if kind != "other"}
    return Setup(**named, other=tuple(_device(f"{where}: other", "other", table) for table in others))


def _device(where: str, kind: str, table: Any) -> Device:
    if not isinstance(table, Mapping) or not isinstance(table.get("name"), str):
        raise StoreError(f'{where}: has no name, expected a table with name = "..."')
    for key in table:
        if key not in KEYS:
            raise StoreError(f"{where}.{key}{near(key, KEYS)}: is no key of a device; {choices(KEYS)}")
    values = dict(table)
    # TOML has dates, and the store keeps text
    if isinstance(values.get("calibrated_on"), date):
        values["calibrated_on"] = values["calibrated_on"].isoformat()
    return Device(kind=kind, **values)
