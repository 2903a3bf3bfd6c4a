"""Invented trees of experiments, as a Butler writes them."""

import json
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

SETUP = {
    "gripper": "claw",
    "arm": {"name": "tentacle", "maker": "somebody", "joints": 6},
    "lamp": "bright",
    "fan": None,
}
CONTEXT = {"dataset": "pots", "dataset_id": "07", "common_name": "teapot", "maker": "potter", "colour": "blue"}
RESULT = {
    "meas_prop": "elasticity",
    "params": {"mean": 42.0, "sigma": 4.5, "units": "kPa"},
    "grasp": {"width_mm": 30},
    "gripper_pose": {"rotation": [1.0, 2.0, 3.0], "translation": [0.1, 0.2, 0.3]},
    "repository": "https://example.org/squeeze",
}
SQUEEZE = {"claw": {"position": [1.0, 2.0, 3.0], "time": [0, 1, 2]}}


def measurement(experiment: Path, files: Mapping[str, Any] = MappingProxyType({}), name: str = "elasticity_0") -> Path:
    """Write a measurement; of its files text and bytes stay as they are, all else is JSON, and None is no file."""
    folder = experiment / name
    given: dict[str, Any] = {
        "data/measurement.json": RESULT,
        "data/object_context.json": CONTEXT,
        "data/forces.json": SQUEEZE,
        "imgs/cam0.png": b"picture",
        "figs/curve.png": b"figure",
        "log.txt": "closing\n",
    }
    for path, content in {**given, **files}.items():
        if content is not None:
            write(folder / path, content)
    return folder


def experiment(folder: Path, setup: Any = SETUP, time: str = "2001_02_03_04_05_06") -> Path:
    """Write an experiment without measurements."""
    path = folder / f"experiment_{time}"
    path.mkdir(parents=True)
    if setup is not None:
        write(path / "setup.json", setup)
    return path


def write(path: Path, content: Any) -> None:
    """Write a file and the folders it is in."""
    path.parent.mkdir(parents=True, exist_ok=True)
    if not isinstance(content, str | bytes):
        content = json.dumps(content)
    # half a surrogate pair is junk that no text holds, and bytes can
    path.write_bytes(content.encode("utf-8", "surrogatepass") if isinstance(content, str) else content)
