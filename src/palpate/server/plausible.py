"""Whether what somebody types of a property can be true of it: a mass is a positive number, a material a label."""

from __future__ import annotations

from functools import lru_cache

from palpate.errors import choices
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.store.entries import Distribution, Entry, FailedEntry
from palpate.store.errors import StoreError
from palpate.store.implausible import positive_fault
from palpate.store.labels import has_numbers, labels_of, seen_unit
from palpate.store.quantities import QUANTITIES
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["check_plausible"]

NO_UNIT = "dimensionless"


def check_plausible(store: Store, entry: Entry, viewer: Viewer) -> None:
    """Refuse a label in place of a number, a number in place of a label or without its unit, and a mass below nothing.

    Of a property that neither everybody knows nor the store has where they see it, anything is taken. Recordings of
    programs are not held to it, as an estimator may well find a negative elasticity: of them it is told
    (`palpate.store.implausible`).

    Raises
    ------
    StoreError
        Naming the field.

    Examples
    --------
    >>> from palpate.store.entries import Value
    >>> from tempfile import TemporaryDirectory
    >>> from palpate.store.opening import open_store
    >>> from palpate.store.viewing import Viewer
    >>> with TemporaryDirectory() as folder, open_store(f"{folder}/store.sqlite") as store:
    ...     check_plausible(store, Value("mass", -5.0, unit="g"), Viewer())
    Traceback (most recent call last):
    palpate.store.errors.StoreError: value: found -5, expected more than 0, as each mass is
    """
    if isinstance(entry, FailedEntry):
        return
    name = entry.property
    unit, labels, states = _unit(store, name, viewer), labels_of(store, name, viewer), _states(name)
    is_number = unit is not None or has_numbers(store, name, viewer)
    if isinstance(entry, Distribution):
        if name in QUANTITIES or (is_number and not labels | states):
            found = next(iter(entry.probabilities), "")
            example = "" if unit is None else f" and a unit such as {unit!r}"
            raise StoreError(f"value: found the label {found[:40]!r}, expected a number{example}, as {name} is one")
        return
    if states or (labels and not is_number):
        raise StoreError(f"value: found a number, and {name} is a label; {choices(sorted(labels | states)[:8])}")
    if unit not in (None, NO_UNIT) and entry.unit is None:
        raise StoreError(f"unit: is missing, expected one of {name}, such as {unit!r}")
    fault = positive_fault(entry)
    if fault is not None:
        raise StoreError(fault)


def _unit(store: Store, name: str, viewer: Viewer) -> str | None:
    return QUANTITIES[name][0] if name in QUANTITIES else seen_unit(store, name, viewer)


@lru_cache(maxsize=256)
def _states(name: str) -> frozenset[str]:
    """Labels that everybody knows of a property."""
    shipped = load_network("household").properties.get(name)
    return frozenset(shipped.states) if isinstance(shipped, CategoricalProperty) else frozenset()
