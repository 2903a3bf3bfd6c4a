"""A network file as nested sections that know where they stand, so that errors can say it."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TypeGuard

from palpate.errors import NetworkError, choices, near

__all__ = ["Layer", "Section", "is_number", "merge", "open_layer", "refuse_cycle", "unknown"]

LARGEST = 1e100


@dataclass(frozen=True)
class Layer:
    """One file: its name in messages and its tables."""

    file: str
    tables: Mapping[str, object]


def open_layer(path: Path) -> Layer:
    """Read a TOML file; NetworkError names the file and the line of a syntax error."""
    try:
        return Layer(str(path), tomllib.loads(path.read_text(encoding="utf-8")))
    except OSError as error:
        raise NetworkError(f"{path}: found a file that cannot be read ({error.strerror}); expected TOML") from None
    except UnicodeDecodeError as error:
        raise NetworkError(f"{path}: found bytes that are not UTF-8 at {error.start}; expected TOML text") from None
    except tomllib.TOMLDecodeError as error:
        raise NetworkError(f"{path}: found a TOML syntax error, {error}; expected TOML 1.0") from None


def merge(under: Mapping[str, object], over: Mapping[str, object]) -> dict[str, object]:
    """Merge tables deeply; values of `over` win, lists are replaced.

    Examples
    --------
    >>> merge({"a": {"x": 1, "y": 2}}, {"a": {"y": 3}, "b": 4})
    {'a': {'x': 1, 'y': 3}, 'b': 4}
    """
    merged = dict(under)
    for key, value in over.items():
        below = merged.get(key)
        merged[key] = merge(below, value) if isinstance(below, Mapping) and isinstance(value, Mapping) else value
    return merged


@dataclass(frozen=True)
class Section:
    """A table of a network, made of the layers of the files it extends (the last wins).

    Reading a value checks its kind; every error names the file that the value is from, the key,
    what was found and what was expected.
    """

    tables: Mapping[str, object]
    layers: Sequence[Layer]
    path: tuple[str, ...] = ()

    def error(self, problem: str, *keys: str) -> NetworkError:
        """An error at this section, or at a key below it."""
        path = (*self.path, *keys)
        origin = next((layer for layer in reversed(self.layers) if _has(layer.tables, path)), self.layers[-1])
        return NetworkError(f"{origin.file}: {'.'.join(path)}: {problem}" if path else f"{origin.file}: {problem}")

    def __contains__(self, key: str) -> bool:
        """Whether the section has the key."""
        return key in self.tables

    def __iter__(self) -> Iterator[str]:
        """The keys in order."""
        return iter(self.tables)

    def only(self, valid: Iterable[str], what: str = "key") -> None:
        """Refuse keys other than the valid ones."""
        names = list(valid)
        for key in self:
            if key not in names:
                raise self.error(unknown(what, key, names), key)

    def need(self, key: str, what: str) -> object:
        """The raw value of a key that must be there."""
        if key not in self.tables:
            raise self.error(f"found no {key!r}; expected {what}")
        return self.tables[key]

    def text(self, key: str, default: str | None = None) -> str:
        """A string."""
        if default is not None and key not in self:
            return default
        value = self.need(key, "a string")
        if not isinstance(value, str):
            raise self.error(f"found {value!r}; expected a string", key)
        return value

    def flag(self, key: str) -> bool:
        """True or false; false where it is not given."""
        value = self.tables.get(key, False)
        if not isinstance(value, bool):
            raise self.error(f"found {value!r}; expected true or false", key)
        return value

    def number(self, key: str, default: float | None = None) -> float:
        """A finite number."""
        if default is not None and key not in self:
            return default
        value = self.need(key, "a number")
        if not is_number(value):
            raise self.error(f"found {value!r}; expected a finite number", key)
        return float(value)

    def positive(self, key: str, default: float | None = None) -> float:
        """A finite number above zero (a default may be zero)."""
        value = self.number(key, default)
        if key in self and value <= 0:
            raise self.error(f"found {value:g}; expected a number above 0", key)
        return value

    def between(self, key: str, low: float, high: float, default: float | None = None) -> float:
        """A finite number from low to high, both included."""
        value = self.number(key, default)
        if not low <= value <= high:
            raise self.error(f"found {value:g}; expected a number from {low:g} to {high:g}", key)
        return value

    def names(self, key: str, default: tuple[str, ...] | None = None) -> tuple[str, ...]:
        """A list of different, non-empty strings."""
        if default is not None and key not in self:
            return default
        value = self.need(key, "a list of names")
        if not isinstance(value, list) or not all(isinstance(item, str) and item for item in value):
            raise self.error(f"found {value!r}; expected a list of names", key)
        for item in value:
            if value.count(item) > 1:
                raise self.error(f"found {item!r} {value.count(item)} times; expected each name once", key)
        return tuple(value)

    def section(self, key: str, what: str = "a table") -> Section:
        """The table of a key that must be there."""
        value = self.need(key, what)
        if not isinstance(value, Mapping):
            raise self.error(f"found {value!r}; expected {what}", key)
        return replace(self, tables=value, path=(*self.path, key))

    def sections(self, key: str) -> dict[str, Section]:
        """The tables within the table of a key, by name; none where it is not given."""
        if key not in self:
            return {}
        group = self.section(key)
        return {name: group.section(name) for name in group}


def is_number(value: object) -> TypeGuard[int | float]:
    """Whether a value is a number (true and false are not) that a float can hold and multiply."""
    return isinstance(value, int | float) and not isinstance(value, bool) and abs(value) <= LARGEST


def unknown(what: str, found: str, valid: Sequence[str]) -> str:
    """What an error says of an unknown name, with the closest valid one if there is one."""
    return f"found the unknown {what} {found!r}{near(found, valid)}; {choices(valid)}"


def refuse_cycle(sections: Mapping[str, Section], edges: Mapping[str, tuple[str, ...]], key: str) -> None:
    """Refuse edges that lead back to where they came from; `key` is where the edges of a section stand."""

    def visit(name: str, trail: tuple[str, ...]) -> None:
        if name in trail:
            loop = " -> ".join((*trail[trail.index(name) :], name))
            raise sections[name].error(f"found the cycle {loop}; expected a graph without cycles", key)
        for target in edges.get(name, ()):
            visit(target, (*trail, name))

    for name in edges:
        visit(name, ())


def _has(tables: object, path: tuple[str, ...]) -> bool:
    if not path:
        return True
    return isinstance(tables, Mapping) and path[0] in tables and _has(tables[path[0]], path[1:])
