"""What is wrong with a form, by the labels that its fields have."""

from __future__ import annotations

from collections.abc import Mapping

__all__ = ["words_of"]

FIELDS: Mapping[str, str] = {
    "thing.dataset": "Data set of the object",
    "thing.id": "Object",
    "action": "Action",
    "when": "When",
    "recorded_at": "When",
    "value": "Value",
    "sd": "SD",
    "entries[0].property": "Property",
    "entries[0].value": "Value",
    "entries[0].probabilities": "Value",
    "entries[0].sd": "SD",
    "entries[0].unit": "Unit",
    "unit": "Unit",
    "setup.other[0].name": "Device",
    "setup.gripper.name": "Device",
    "setup.arm.name": "Device",
    "setup.camera.name": "Device",
    "setup.microphone.name": "Device",
    "kind": "Kind of device",
    "visibility": "Who may see it",
    "into": "Data set and name of the other one",
    "shows_name": "Others may learn its name",
    "until": "But not before",
    "embargoed_until": "But not before",
}


def words_of(fault: str) -> str:
    """A fault that begins with a field of a recording, with the label of that field in its place.

    Examples
    --------
    >>> words_of("entries[0].unit: unit 'g' is mass; expected pressure, as 'Pa'")
    "Unit: unit 'g' is mass; expected pressure, as 'Pa'"
    """
    field, colon, rest = fault.partition(": ")
    return f"{FIELDS[field]}: {rest}" if colon and field in FIELDS else fault
