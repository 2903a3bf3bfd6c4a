"""A made-up folder of recordings in the published layout."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

ENTRIES = ("cat-vision", "mat-vision", "mat-sound", "elasticity", "density")


def content(entry: str, number: int) -> dict[str, Any]:
    """What a measurement file holds, each a little different."""
    shift = 0.02 * number
    values: dict[str, Any] = {
        "cat-vision": {"values": {"prediction": {"mug": 0.7 - shift, "kettle": 0.2 + shift, "bowl": 0.1}}},
        "mat-vision": {"values": {"prediction": {"plastic": 0.5 - shift, "ceramic": 0.3, "water": 0.2 + shift}}},
        "mat-sound": {"values": {"ceramic": 0.8 - shift, "glass": 0.2 + shift}},
        "elasticity": {"params": {"mean": 140.0 + number, "sigma": 4.0}},
        "density": {"values": {"arm": {"joint4_torque": [320.0 + number, 330.0 + number]}}},
    }
    return {"meas_prop": entry, **values[entry]}


def write_recordings(folder: Path, objects: tuple[str, ...] = ("ceramic_mug", "banana")) -> Path:
    """Write five measurements of each entry and object."""
    for name in objects:
        for entry in ENTRIES:
            for number in range(5):
                write(folder, name, entry, number, content(entry, number))
    return folder


def write(folder: Path, name: str, entry: str, number: int, found: object) -> Path:
    """Write one file."""
    file = folder / f"experiment_{name}" / f"{entry}_{number}" / "data" / "measurement.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(found if isinstance(found, str) else json.dumps(found), encoding="utf-8")
    return file
