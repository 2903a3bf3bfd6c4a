"""Fields of a line as somebody writes them by hand: what is wrong is told by the place where it is."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import MISSING, fields
from functools import partial
from typing import Any

from palpate.errors import choices
from palpate.store.content import KINDS
from palpate.store.errors import StoreError
from palpate.store.importing.plain import decode
from palpate.store.records import DEVICE_KINDS, Device, Pose, ThingRef

__all__ = ["decoded", "named"]

ENTRIES: Mapping[str, type] = {kind: entry for entry, kind in KINDS.items()}
MOMENT = "a time such as 2024-05-01T12:00:00Z"
EXPECTED: Mapping[str, str] = {
    "id": "a UUID",
    "recorded_at": MOMENT,
    "embargoed_until": f"{MOMENT}, or null",
    "notices": "a list of texts",
    "thing": "dataset and id as texts, and aliases as a list of them",
    "gripper_pose": "translation_m as a list of three numbers, and quaternion as one of four or null",
    "object_pose": "translation_m as a list of three numbers, and quaternion as one of four or null",
}
OTHER = "other"


def decoded(plain: Mapping[str, Any]) -> dict[str, Any]:
    """The fields of a recording, from those of a line.

    Raises
    ------
    StoreError
        Naming the place that is unknown, missing or not what stands there.

    Examples
    --------
    >>> decoded({"setup": {"gripper": {"name": "Robotiq 2F-85"}}})["setup"].gripper.kind
    'gripper'
    >>> decoded({"setup": {"gripper": {}}})
    Traceback (most recent call last):
    palpate.store.errors.StoreError: setup.gripper.name: is missing, expected it beside kind
    """
    found: dict[str, Any] = {}
    for name, value in plain.items():
        whole = WHOLE[name](value) if name in WHOLE else value
        try:
            found |= decode({name: whole}, "line")
        except StoreError as error:
            if name not in EXPECTED:
                raise
            raise StoreError(f"{name}: cannot be read, expected {EXPECTED[name]}") from error
    return found


def named(where: str, plain: Any, needed: Collection[str], more: Collection[str]) -> dict[str, Any]:
    """An object with all names that are needed and none that is unknown."""
    if not isinstance(plain, dict):
        told = f" with {', '.join(needed)}" if needed else ""
        raise StoreError(f"{where}: is a {type(plain).__name__}, expected an object{told}")
    for name in needed:
        if name not in plain:
            beside = ", ".join(one for one in needed if one != name)
            raise StoreError(f"{where}.{name}: is missing" + (f", expected it beside {beside}" if beside else ""))
    for name in plain:
        if name not in (*needed, *more):
            raise StoreError(f"{where}: {str(name)[:40]!r} is unknown, expected {', '.join((*needed, *more))}")
    return plain


def _of_class(where: str, plain: Any, made: type, also: Collection[str] = ()) -> dict[str, Any]:
    """What a data class can be made of."""
    needed = [one.name for one in fields(made) if one.default is MISSING and one.default_factory is MISSING]
    return named(where, plain, (*also, *needed), [one.name for one in fields(made) if one.name not in needed])


def _thing(plain: Any) -> dict[str, Any]:
    return {"aliases": [], **_of_class("thing", plain, ThingRef)}


def _setup(plain: Any) -> dict[str, Any]:
    """Devices by their kinds, which need not be said again; `other` is a list, and may be left out."""
    given = named("setup", plain, (), DEVICE_KINDS)
    others = given.get(OTHER, [])
    if not isinstance(others, list):
        raise StoreError(f"setup.{OTHER}: is a {type(others).__name__}, expected a list")
    kept = {kind: _device(f"setup.{kind}", kind, one) for kind, one in given.items() if kind != OTHER}
    return {**kept, OTHER: [_device(f"setup.{OTHER}[{n}]", OTHER, one) for n, one in enumerate(others)]}


def _device(where: str, kind: str, plain: Any) -> dict[str, Any] | None:
    if plain is None and kind != OTHER:
        return None
    return _of_class(where, {"kind": kind, **plain} if isinstance(plain, dict) else plain, Device)


def _entries(plain: Any) -> list[dict[str, Any]]:
    if not isinstance(plain, list):
        raise StoreError(f"entries: is a {type(plain).__name__}, expected a list")
    return [_entry(f"entries[{place}]", one) for place, one in enumerate(plain)]


def _entry(where: str, plain: Any) -> dict[str, Any]:
    kind = plain.get("kind") if isinstance(plain, dict) else None
    if isinstance(plain, dict) and not (isinstance(kind, str) and kind in ENTRIES):
        raise StoreError(f"{where}.kind: found {str(kind)[:40]!r}; {choices(ENTRIES)}")
    return named(where, plain, ("kind",), ()) if kind is None else _of_class(where, plain, ENTRIES[kind], ("kind",))


def _pose(where: str, plain: Any) -> dict[str, Any] | None:
    if plain is None:
        return None
    return {"quaternion": None, "frame": "base", "original": {}, **_of_class(where, plain, Pose)}


WHOLE: Mapping[str, Callable[[Any], Any]] = {
    "thing": _thing,
    "setup": _setup,
    "entries": _entries,
    "gripper_pose": partial(_pose, "gripper_pose"),
    "object_pose": partial(_pose, "object_pose"),
}
