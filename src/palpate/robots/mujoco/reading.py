"""Reading objects for the bench: shapes and looks from a file, what is true of them from a network."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Any, TypeVar

from palpate.errors import choices, near
from palpate.network.model import KnownObject, Network
from palpate.network.properties import CategoricalProperty
from palpate.network.units import UnitError, factor
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.objects import BenchObject, Look, Part
from palpate.robots.mujoco.sound import Substance

__all__ = ["FORMAT", "SHIPPED", "bench_object", "read_roles", "read_substances"]

FORMAT = "palpate-bench/1"
SHIPPED = Path(__file__).parents[2] / "data" / "bench" / "objects.toml"
ROLES = ("mass", "elasticity", "substance")
UNITS = {"mass": "g", "elasticity": "kPa"}
T = TypeVar("T", BenchObject, Look, Substance)


def bench_object(network: Network, name: str, path: str | Path = SHIPPED) -> BenchObject:
    """Make an object of a network for the bench.

    Parameters
    ----------
    name
        One of the network's objects. Where the file has no entry for it, the entry of what it looks like counts.
    path
        File of shapes and looks; the shipped one holds those of the shipped network.

    Raises
    ------
    EvidenceError
        The network does not know the object.
    BenchError
        The file cannot be used, or it or the network lacks something.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> trick = bench_object(load_network("household"), "wineglass_ycb")
    >>> trick.mass_g, trick.size_mm
    (133.0, (84.0, 78.0, 200.0))
    """
    document = _Document(Path(path))
    known = network.object(name)
    entry = document.entry(known)
    roles = document.roles()
    found = {role: _true(network, known, role, roles[role], document.where) for role in ROLES}
    parts = tuple(document.part(name, part) for part in entry.get("parts", ()))
    numbers = {key: value for key, value in entry.items() if key != "parts"}
    substance = document.substance(str(found["substance"]))
    return _make(
        BenchObject,
        f"{document.where}: object {name!r}",
        {
            **numbers,
            "name": name,
            "mass_g": found["mass"],
            "elasticity_kpa": found["elasticity"],
            "substance": substance,
            "parts": parts,
        },
    )


def read_roles(path: str | Path = SHIPPED) -> dict[str, str]:
    """Names of the properties that the bench takes for mass, elasticity and substance; BenchError if it cannot be read.

    Examples
    --------
    >>> read_roles()["substance"]
    'material'
    """
    return _Document(Path(path)).roles()


def read_substances(path: str | Path = SHIPPED) -> dict[str, Substance]:
    """What a file says of the sound of each state of the property that the bench takes for the substance.

    Examples
    --------
    >>> read_substances()["glass"].density_kgm3
    2600.0
    """
    return _Document(Path(path)).substances()


class _Document:
    """The file, with errors that say where."""

    def __init__(self, path: Path) -> None:
        # where a package is installed is of no interest
        self.where = "the bench's own objects" if path == SHIPPED else str(path)
        try:
            self._content = tomllib.loads(path.read_text(encoding="utf-8"))
        except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
            raise BenchError(f"{path} cannot be read as TOML: {error}") from error
        if self._content.get("format") != FORMAT:
            raise BenchError(f"{path}: format {self._content.get('format')!r} was found, expected {FORMAT!r}")

    def entry(self, known: KnownObject) -> dict[str, Any]:
        objects = self._table("objects")
        for name in (known.name, known.looks_like):
            if name in objects:
                return dict(objects[name])
        raise BenchError(
            f"{self.where}: no shape of object {known.name!r} was found{near(known.name, objects)}: {choices(objects)}"
            ", or name a file that has its shape (palpate explore --shapes FILE)"
        )

    def roles(self) -> dict[str, str]:
        return {**{role: role for role in ROLES}, **self._table("properties")}

    def substance(self, state: str) -> Substance:
        substances = self._table("substances")
        if state not in substances:
            hint = near(state, substances)
            raise BenchError(f"{self.where}: no substance {state!r} was found{hint}: {choices(substances)}")
        return _make(Substance, f"{self.where}: substance {state!r}", substances[state])

    def substances(self) -> dict[str, Substance]:
        return {state: self.substance(state) for state in self._table("substances")}

    def part(self, name: str, part: Mapping[str, Any]) -> Part:
        looks, where = self._table("looks"), f"{self.where}: a part of object {name!r}"
        for key in ("kind", "look"):
            if key not in part:
                raise BenchError(f"{where} lacks {key!r}")
        if part["look"] not in looks:
            raise BenchError(f"{where}: no look {part['look']!r} was found: {choices(looks)}")
        look = _make(Look, f"{self.where}: look {part['look']!r}", looks[part["look"]])
        return Part(part["kind"], look, {key: part[key] for key in part if key not in ("kind", "look")})

    def _table(self, key: str) -> dict[str, Any]:
        table = self._content.get(key, {})
        if not isinstance(table, dict):
            raise BenchError(f"{self.where}: {key} {table!r} was found, expected a table")
        return table


def _true(network: Network, known: KnownObject, role: str, name: str, where: str) -> str | float:
    """What is true of an object, in the bench's units."""
    if name not in network.properties or name not in known.truth:
        raise BenchError(
            f"{where}: properties: {role} = {name!r} was found, expected one that network {network.name!r} has and "
            f"object {known.name!r} tells: {choices(known.truth)}"
        )
    value = known.truth[name].value
    if role not in UNITS:
        return value
    measured = network.property(name)
    if isinstance(value, str) or isinstance(measured, CategoricalProperty):
        raise BenchError(f"{where}: properties: {role} = {name!r} was found, expected a property that is a number")
    try:
        return value * factor(measured.unit, UNITS[role])
    except UnitError as error:
        raise BenchError(f"{where}: properties: {role} = {name!r}: {error}") from error


def _make(kind: type[T], where: str, entry: Mapping[str, Any]) -> T:
    names = {field.name for field in fields(kind)}
    for key in entry:
        if key not in names:
            raise BenchError(f"{where}: unknown key {key!r}{near(key, names)}: {choices(sorted(names))}")
    tidy = {key: _tidy(value) for key, value in entry.items()}
    try:
        return kind(**tidy)
    except TypeError as error:
        raise BenchError(f"{where}: {str(error).partition(') ')[2]}") from error


def _tidy(value: Any) -> Any:
    """Numbers as floats, lists of numbers as tuples."""
    if isinstance(value, list) and all(isinstance(item, int | float) for item in value):
        return tuple(float(item) for item in value)
    return float(value) if isinstance(value, int) and not isinstance(value, bool) else value
