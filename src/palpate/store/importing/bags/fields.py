"""Fields of messages: ``wrench.force.x``, ``position[0]``, and ``effort[joint_4]`` by the name beside the array."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from keyword import iskeyword
from typing import Any, Final

from palpate.errors import choices, near
from palpate.store.errors import StoreError

__all__ = ["MISSING", "FieldPath", "Missing", "member"]

NAMED_BY = ("name", "names", "joint_names")
"""Fields that name the elements of the arrays beside them."""

NOTHING: Mapping[str, Any] = {}
STEP = re.compile(r"(?P<name>[A-Za-z_]\w*)(\[(?P<key>[^\[\]]+)\])?", re.ASCII)


class Missing(Enum):
    """What stands for a value that a message does not hold."""

    MISSING = "missing"


MISSING: Final = Missing.MISSING


@dataclass(frozen=True)
class Step:
    """A field, and which of its elements: by place, or by name."""

    name: str
    key: int | str | None = None


@dataclass(frozen=True)
class FieldPath:
    """Where in a message a value stands.

    Examples
    --------
    >>> path = FieldPath.parse("effort[joint_4]")
    >>> path.of({"name": ["joint_3", "joint_4"], "effort": [0.5, 1.5]})
    1.5
    >>> path.of({"name": ["joint_3"], "effort": [0.5]})
    <Missing.MISSING: 'missing'>
    """

    text: str
    steps: tuple[Step, ...]

    @classmethod
    def parse(cls, text: str) -> FieldPath:
        """Read a path; in brackets stand digits for a place, anything else for a name (a name of digits in quotes).

        Raises
        ------
        StoreError
            If it is none.
        """
        steps, end = [], 0
        while match := STEP.match(text, end):
            key = match["key"]
            steps.append(Step(match["name"], int(key) if key and key.isdecimal() else key and key.strip("'\"")))
            end = match.end()
            if end == len(text):
                return cls(text, tuple(steps))
            if text[end] != ".":
                break
            end += 1
        raise StoreError(f"{text!r} is no field, expected one such as 'wrench.force.x' or 'effort[joint_4]'")

    def of(self, message: Any) -> Any:
        """The value that a message holds there, or `MISSING`."""
        passed = []
        for step in self.steps:
            passed.append(message)
            message = member(message, step.name)
            if step.key is not None and message is not MISSING:
                message = _element(message, step.key, passed)
            if message is MISSING or message is None:
                return MISSING
        return message

    def complaint(self, message: Any) -> str:
        """Why a message does not hold it, and what it holds instead."""
        passed = []
        for step in self.steps:
            passed.append(message)
            inner = member(message, step.name)
            if inner is MISSING or inner is None:
                names = [name for name in _members(message) if not name.startswith("_")]
                what = choices(names) if names else "it has no fields"
                return f"there is no field {step.name!r}{near(step.name, names)}; {what}"
            message = inner if step.key is None else _element(inner, step.key, passed)
            if message is MISSING:
                return _no_element(step, inner, passed)
        return f"there is no {self.text!r}"


def member(message: Any, name: str) -> Any:
    """A field of a message, or `MISSING`; nothing but its fields, whatever else Python has under that name."""
    fields = _members(message)
    if name in fields:
        return fields[name]
    # a field may have the name of a keyword
    return fields.get(name + "_", MISSING) if iskeyword(name) else MISSING


def _members(message: Any) -> Mapping[str, Any]:
    # what JSON becomes, or an object of its type
    return message if type(message) is dict else getattr(message, "__dict__", NOTHING)


def _element(array: Any, key: int | str, passed: Sequence[Any]) -> Any:
    place = key if type(key) is int else _place(key, passed)
    if place is None or type(array) in (str, dict) or not hasattr(array, "__len__") or place >= len(array):
        return MISSING
    return array[place]


def _place(key: object, passed: Sequence[Any]) -> int | None:
    """Where a name is among those of the elements, beside the array or beside what it is in."""
    for message in reversed(passed):
        fields = _members(message)
        for field in NAMED_BY:
            names = fields.get(field)
            if type(names) is list and key in names:
                return names.index(key)
    return None


def _no_element(step: Step, array: Any, passed: Sequence[Any]) -> str:
    if isinstance(step.key, str):
        fields = [_members(message).get(field) for message in passed for field in NAMED_BY]
        names = [name for names in fields if isinstance(names, list) for name in names]
        if not names:
            return f"{step.name!r} has no names beside it, expected one of the fields {', '.join(NAMED_BY)}"
        if step.key not in names:
            return f"nothing in {step.name!r} is named {step.key!r}{near(step.key, names)}; {choices(names)}"
    count = len(array) if hasattr(array, "__len__") else 0
    return f"{step.name!r} has {count} elements, too few for [{step.key}]"
