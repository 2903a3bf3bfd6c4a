import inspect
import json
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from palpate.network.units import SHIPPED, unit_of
from palpate.store import quantities
from palpate.store.archive import export_archive
from palpate.store.describing import change_thing
from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.own_formats import Archives
from palpate.store.opening import open_store
from palpate.store.quantities import QUANTITIES, check_quantity
from palpate.store.records import Channel, Recording, Series
from palpate.store.store import Store
from palpate.store.things import find_thing
from palpate.store.units import change_unit, list_units
from palpate.store.verifying import verify
from tests.store.made_up import squeeze


@pytest.mark.parametrize(
    ("name", "right", "wrong"),
    [
        ("position", ["mm", "degree", "percent"], ["kg", "A", "s"]),
        ("current", ["A", "mA"], ["N", "V", "dimensionless"]),
        ("force", ["N", "kN"], ["kg", "N*m", "kPa"]),
        ("torque", ["N*m"], ["N", "W"]),
        ("mass", ["g", "kg"], ["N", "cm^3", "kPa"]),
        ("elasticity", ["kPa", "N/mm^2"], ["g", "N/mm", "percent"]),
        ("density", ["kg/m^3", "g/cm^3"], ["kg", "g/cm^2"]),
        ("volume", ["cm^3", "mL"], ["cm^2", "g"]),
        ("temperature", ["K"], ["degC", "J"]),
        ("audio", ["dimensionless", "Pa", "V"], ["m", "Hz"]),
        ("fluff", ["g", "kPa"], ["no such unit"]),
    ],
)
def test_what_everybody_knows_has_its_dimension(name: str, right: list[str], wrong: list[str]) -> None:
    """Every unit of a right dimension will do and no other; of a lab's own quantity any known unit."""
    for unit in right:
        check_quantity("here", unit, name)
    for unit in wrong:
        with pytest.raises(StoreError, match=r"^here: un"):
            check_quantity("here", unit, name)


def test_dimensions_of_one_quantity_differ() -> None:
    """No unit stands in the table twice, under another name."""
    for units in QUANTITIES.values():
        dimensions = [tuple(unit_of(unit).dimension.items()) for unit in units]
        assert len(set(dimensions)) == len(dimensions)


@contextmanager
def before_it_was_known() -> Iterator[None]:
    """The time of a version in which these quantities had any dimension."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(quantities, "QUANTITIES", {})
        # without what is remembered of today
        patch.setattr(quantities, "quantity_fault", inspect.unwrap(quantities.quantity_fault))
        yield


@pytest.fixture
def old(local: Store) -> tuple[Store, Recording]:
    """A store of that time, with a recording and something known that would be refused by now."""
    odd = Channel("way", "position", "kg", np.arange(3.0), rate_hz=10.0)
    recording = squeeze(series=(Series("arm", (odd,)),), entries=(Value("mass", 1.0, unit="N"),))
    with before_it_was_known():
        local.put(recording)
        change_thing(local, recording.thing, lambda thing: thing.knowing(Value("mass", 2.0, unit="N"), "a person"))
    with pytest.raises(StoreError, match="expected length"):
        local.put(replace(recording, action="again"))
    return local, recording


def test_what_a_store_has_kept_stays_readable(old: tuple[Store, Recording]) -> None:
    """It is read, described otherwise and told anew; what is new has the right dimension."""
    store, recording = old
    assert list(verify(store)) == []
    change_thing(store, recording.thing, lambda thing: thing.described(maker="somebody"))
    with pytest.raises(StoreError, match="expected mass"):
        change_thing(store, recording.thing, lambda thing: thing.knowing(Value("mass", 2.0, unit="N"), "a scale"))
    change_thing(store, recording.thing, lambda thing: thing.without("mass"))
    change_unit(store, "mass", "kg", wrong=True)
    change_thing(store, recording.thing, lambda thing: thing.knowing(Value("mass", 2.0, unit="g"), "a scale"))


@pytest.mark.parametrize("is_taken_back", [False, True])
def test_an_archive_of_what_a_store_has_kept_is_restored(
    old: tuple[Store, Recording], tmp_path: Path, *, is_taken_back: bool
) -> None:
    """A back-up gives all back, though it could not be measured so any more."""
    store, recording = old
    if is_taken_back:
        change_thing(store, recording.thing, lambda thing: thing.without("mass"))
        change_unit(store, "mass", "kg", wrong=True)
        store.put(squeeze(1))
    export_archive(store, tmp_path / "archive")
    with open_store(tmp_path / "other.sqlite", durable=False) as other:
        outcomes = list(import_paths(other, [tmp_path / "archive"], [Archives()]))
        assert {one.fate for one in outcomes} == {Fate.NEW}
        assert other.get(recording.digest) == recording
        assert find_thing(other, recording.thing.id) == find_thing(store, recording.thing.id)
        assert list_units(other) == list_units(store)
        assert list(verify(other)) == []


def test_units_of_known_quantities_ship() -> None:
    """A store that is sent a common signal does not load pint for it, which takes a second."""
    shipped = json.loads(SHIPPED.read_text(encoding="utf-8"))
    assert {unit for units in QUANTITIES.values() for unit in units} <= shipped.keys()
