"""The fields of a recording as JSON can hold them, and back; arrays and files are beside it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any
from uuid import UUID

from palpate.store.content import entry_plain, pose_plain, setup_plain, thing_plain
from palpate.store.decoding import entry_from, pose_from, setup_from, thing_from
from palpate.store.errors import StoreError
from palpate.store.records import Recording

__all__ = ["FIELDS", "LATER", "decode", "encode", "updated"]

FIELDS = tuple(name for name in Recording.__dataclass_fields__ if name not in ("series", "files", "log"))
"""Fields that JSON can hold."""

LATER = ("embargoed_until",)
"""Fields that earlier versions do not know, and that are written only where they say something."""

APPENDED = ("entries", "notices")
"""Fields that hold several values, of which more can come."""


def encode(fields: Mapping[str, Any]) -> dict[str, Any]:
    """Return fields of a recording, by their names, as JSON can hold them.

    Examples
    --------
    >>> encode({"action": "weighing", "notices": ("cold",)})
    {'action': 'weighing', 'notices': ['cold']}
    """
    return {name: _ENCODE.get(name, _as_it_is)(value) for name, value in fields.items() if _is_told(name, value)}


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


def _is_told(name: str, value: Any) -> bool:
    return name not in LATER or value is not None


def _as_it_is(value: Any) -> Any:
    return value


_ENCODE: Mapping[str, Callable[[Any], Any]] = {
    "id": str,
    "recorded_at": datetime.isoformat,
    "thing": thing_plain,
    "setup": setup_plain,
    "gripper_pose": pose_plain,
    "object_pose": pose_plain,
    "entries": lambda entries: [entry_plain(entry) for entry in entries],
    "notices": list,
    "embargoed_until": datetime.isoformat,
}
_DECODE: Mapping[str, Callable[[Any], Any]] = {
    "id": UUID,
    "recorded_at": datetime.fromisoformat,
    "thing": thing_from,
    "setup": setup_from,
    "gripper_pose": pose_from,
    "object_pose": pose_from,
    "entries": lambda plain: tuple(map(entry_from, plain)),
    "notices": tuple,
    "embargoed_until": lambda plain: None if plain is None else datetime.fromisoformat(plain),
}
