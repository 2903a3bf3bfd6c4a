"""Parts of a measurement as the paper's programs write it: object, devices, grasp, poses, series."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from palpate.errors import LogError
from palpate.network.document import is_number
from palpate.store.importing.upload_format import Conventions
from palpate.store.records import DEVICE_KINDS, Channel, Device, Pose, Series, Setup, ThingRef

__all__ = ["grasp_of", "pose_of", "series_of", "setup_of", "thing_of"]

NOWHERE = "unnamed"
"""The dataset of an object whose file names none."""


def thing_of(given: Mapping[str, Any], notices: list[str]) -> ThingRef:
    """The object; what is said of it beyond its names are its attributes."""
    rest = dict(given)
    common_name, dataset, known_as, maker = (
        rest.pop(key, None) or None for key in ("common_name", "dataset", "dataset_id", "maker")
    )
    if dataset is None or known_as is None:
        notices.append("no data set with an id in it is named: the object's common name is its id")
        dataset, known_as = dataset or NOWHERE, known_as or common_name or ""
    return ThingRef(dataset, known_as, maker, common_name, {key: value for key, value in rest.items() if value})


def setup_of(given: Mapping[str, Any]) -> Setup:
    """The devices; what is of no known kind is among the others, with the word that the file has for it."""
    named = dict[str, Device]()
    others = list[Device]()
    for kind, value in sorted((kind, value) for kind, value in given.items() if value):
        device = _device(kind, value)
        if device.kind == "other":
            others.append(device)
        else:
            named[kind] = device
    return Setup(**named, other=tuple(others))


def _device(kind: str, given: Any) -> Device:
    """A device from its name, from an object with its name and parameters, or from anything else as a parameter."""
    name = given.get("name") if isinstance(given, Mapping) else given
    if not isinstance(name, str):
        return Device("other", kind, parameters={"given": given})
    parameters = {key: value for key, value in given.items() if key != "name"} if isinstance(given, Mapping) else {}
    maker = parameters.pop("maker") if isinstance(parameters.get("maker"), str) else None
    if kind in DEVICE_KINDS[:-1]:
        return Device(kind, name, maker, parameters)
    return Device("other", name, maker, {"kind": kind, **parameters})


def grasp_of(measurement: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """How the object was held, in the file's own words."""
    grasp = measurement.get("grasp")
    return grasp if grasp is None or isinstance(grasp, Mapping) else {"given": grasp}


def pose_of(measurement: Mapping[str, Any], key: str, where: str, notices: list[str]) -> Pose | None:
    """A pose without units, frame and convention; its rotation is kept as given.

    Raises
    ------
    LogError
        If it has no translation of three numbers.
    """
    given = measurement.get(key)
    if given is None:
        return None
    place = given.get("translation") if isinstance(given, Mapping) else None
    if not isinstance(place, list) or len(place) != 3 or not all(is_number(part) for part in place):
        raise LogError(f"{where}{key}: expected an object with a translation of three numbers")
    notices.append(
        f"{key} states no units and no frame: metres are assumed; its rotation has no convention and is kept as given"
    )
    return Pose((place[0], place[1], place[2]), None, "unstated", given)


def series_of(
    samples: Mapping[str, Sequence[float]], conventions: Conventions, notices: list[str]
) -> tuple[Series, ...]:
    """Series of each device, from samples by ``device.channel``."""
    devices: dict[str, list[Channel]] = {}
    units = dict(conventions.from_series.values())
    for full, values in samples.items():
        device, _, name = full.rpartition(".")
        quantity = conventions.quantities.get(name, name)
        devices.setdefault(device, []).append(Channel(name, quantity, units.get(name), np.asarray(values)))
        if name in conventions.remarks:
            notices.append(f"{full} {conventions.remarks[name]}")
    return tuple(Series(device, tuple(channels)) for device, channels in devices.items())
