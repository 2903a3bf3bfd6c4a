"""The fields of a recording as JSON can hold them, and back; arrays and files are beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any
from uuid import UUID

from palpate.store.content import entry_plain, setup_plain, thing_plain
from palpate.store.decoding import entry_from, setup_from, thing_from
from palpate.store.errors import StoreError
from palpate.store.records import Pose, Recording

__all__ = ["FIELDS", "decode", "encode", "updated"]

FIELDS = tuple(name for name in Recording.__dataclass_fields__ if name not in ("series", "files", "log"))
"""Fields that JSON can hold."""

APPENDED = ("entries", "notices")
"""Fields that hold several values, of which more can come."""


def encode(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of a recording, by their names, as JSON can hold them.

    Examples
    --------
    >>> encode({"action": "weighing", "notices": ("cold",)})
    {'action': 'weighing', 'notices': ['cold']}
    """
    return {name: _ENCODE.get(name, _as_it_is)(value) for name, value in fields.items()}


def decode(plain: Mapping[str, Any], where: str) -> dict[str, Any]:
    """Return what `encode` was given.

    Raises
    ------
    StoreError
        If a field is unknown or is not what stands in such a field; `where` begins the message.
    """
    fields = {}
    for name, value in plain.items():
        if name not in FIELDS:
            raise StoreError(f"{where}: {name!r} is no field of a recording")
        try:
            fields[name] = _DECODE.get(name, _as_it_is)(value)
        except (AttributeError, KeyError, TypeError, ValueError) as error:
            raise StoreError(f"{where}: {name!r} cannot be read ({error!r}), expected what palpate writes") from error
    return fields


def updated(recording: Recording, fields: Mapping[str, Any]) -> Recording:
    """Return a recording with other fields; entries and notices come after those that are there."""
    appended = {name: (*getattr(recording, name), *fields[name]) for name in APPENDED if name in fields}
    return replace(recording, **{**fields, **appended})


def _as_it_is(value: Any) -> Any:
    return value


def _pose_plain(pose: Pose | None) -> dict[str, Any] | None:
    if pose is None:
        return None
    quaternion = None if pose.quaternion is None else list(map(float, pose.quaternion))
    return {**vars(pose), "translation_m": list(map(float, pose.translation_m)), "quaternion": quaternion}


def _pose(plain: Any) -> Pose | None:
    if plain is None:
        return None
    quaternion = None if plain["quaternion"] is None else tuple(plain["quaternion"])
    return Pose(**{**plain, "translation_m": tuple(plain["translation_m"]), "quaternion": quaternion})


_ENCODE: Mapping[str, Callable[[Any], Any]] = {
    "id": str,
    "recorded_at": datetime.isoformat,
    "thing": thing_plain,
    "setup": setup_plain,
    "gripper_pose": _pose_plain,
    "object_pose": _pose_plain,
    "entries": lambda entries: [entry_plain(entry) for entry in entries],
    "notices": list,
}
_DECODE: Mapping[str, Callable[[Any], Any]] = {
    "id": UUID,
    "recorded_at": datetime.fromisoformat,
    "thing": thing_from,
    "setup": setup_from,
    "gripper_pose": _pose,
    "object_pose": _pose,
    "entries": lambda plain: tuple(map(entry_from, plain)),
    "notices": tuple,
}
