"""A network's tables as the text of a TOML file: a section for each property and sensor, a line for each row."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from datetime import date, time

from palpate.errors import NetworkError

__all__ = ["to_toml"]

INLINE = ("given", "prior", "counts", "truth")
"""Tables whose rows are written in one line each."""
BARE = frozenset("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-")
ESCAPES = {'"': '\\"', "\\": "\\\\", "\n": "\\n", "\t": "\\t", "\r": "\\r", "\b": "\\b", "\f": "\\f"}


def to_toml(tables: Mapping[str, object]) -> str:
    """Write tables so that `tomllib` reads the same.

    Raises
    ------
    NetworkError
        If a value is none that TOML has.

    Examples
    --------
    >>> print(to_toml({"name": "box", "properties": {"kind": {"states": ["a", "b"], "counts": [3, 1]}}}))
    name = "box"
    <BLANKLINE>
    [properties.kind]
    states = ["a", "b"]
    counts = [3, 1]
    <BLANKLINE>
    """
    return "\n".join(_lines(tables, ())).lstrip("\n") + "\n"


def _lines(table: Mapping[str, object], path: tuple[str, ...]) -> Iterator[str]:
    rows = {key: value for key, value in table.items() if not _has_section(value, path)}
    if path and (rows or not table):
        yield from _heading(path)
    width = max((len(_key(key)) for key in rows if path[-1:] and path[-1] in INLINE), default=0)
    for key, value in rows.items():
        yield f"{_key(key):{width}} = {_value(value)}"
    for key, value in table.items():
        if key not in rows and isinstance(value, Mapping):
            yield from _lines(value, (*path, key))


def _heading(path: tuple[str, ...]) -> Iterator[str]:
    # the rows of a property stand close to it
    if path[-1] not in (*INLINE, "sensor"):
        yield ""
    yield f"[{'.'.join(map(_key, path))}]"


def _has_section(value: object, path: tuple[str, ...]) -> bool:
    """Whether a value is a table that gets a section of its own; a row of one is written in a line."""
    return isinstance(value, Mapping) and not (path and path[-1] in INLINE)


def _key(key: str) -> str:
    return key if key and BARE.issuperset(key) else _text(key)


def _value(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return _text(value)
    if isinstance(value, int | date | time):
        return str(value)
    if isinstance(value, float):
        return repr(float(value)) if math.isfinite(value) else str(float(value))
    if isinstance(value, Mapping):
        inner = ", ".join(f"{_key(key)} = {_value(item)}" for key, item in value.items())
        return f"{{{inner}}}"
    if isinstance(value, Sequence):
        return f"[{', '.join(map(_value, value))}]"
    raise NetworkError(f"found {type(value).__name__} {value!r}; expected what TOML can hold")


def _text(text: str) -> str:
    return '"' + "".join(ESCAPES.get(letter) or _character(letter) for letter in text) + '"'


def _character(letter: str) -> str:
    return f"\\u{ord(letter):04x}" if ord(letter) < 32 or ord(letter) == 127 else letter
