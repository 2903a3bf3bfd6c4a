"""Devices against what is known, by hand and against the plain formulas."""

from statistics import fmean, stdev

import numpy as np
import pytest

from palpate.server.benchmark import agreements
from palpate.store.describing import change_thing
from palpate.store.entries import Value
from palpate.store.merging import merge_things
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from tests.store.made_up import squeeze

CUP, BOWL, COPY = (ThingRef("lab", name) for name in ("cup", "bowl", "copy"))


def weighed(number: int, thing: ThingRef, gripper: str, grams: float, **changes: object) -> Recording:
    fields = {
        "visibility": "public",
        "thing": thing,
        "setup": Setup(gripper=Device("gripper", gripper, calibrated_on=f"2024-01-0{number % 2 + 1}")),
        "entries": (Value("mass", grams, 1.0, "g"),),
    }
    return squeeze(number, **{**fields, **changes})


def test_errors_are_those_of_the_plain_formulas(store: Store) -> None:
    """Two calibrations of a device count as one device, a copy as what it was merged into; kilograms as grams."""
    rng = np.random.default_rng(3)
    values = {gripper: rng.normal(mean, 5, 9).tolist() for gripper, mean in (("left", 103), ("right", 92))}
    number = 0
    for gripper, grams in values.items():
        for place, one in enumerate(grams):
            number += 1
            store.put(weighed(number, CUP if place % 3 else COPY, gripper, one))
    merge_things(store, COPY, CUP)
    change_thing(store, CUP, lambda thing: thing.knowing(Value("mass", 0.1, unit="kg"), "a scale"))
    # of the bowl a recording tells the truth
    store.put_many([weighed(50, BOWL, "left", 40.0), weighed(51, BOWL, "scale", 42.0, ground_truth=True)])
    found = agreements(store, Viewer(), "mass")
    cells = {(cell.device, cell.thing): cell for cell in found.cells}
    assert set(cells) == {("left", "cup"), ("right", "cup"), ("left", "bowl")}
    for gripper, grams in values.items():
        cell = cells[gripper, "cup"]
        assert (cell.count, found.unit) == (9, "g")
        assert (cell.mean, cell.sd) == pytest.approx((fmean(grams), stdev(grams)))
        assert cell.error == pytest.approx(fmean(grams) - 100)
    assert cells["left", "bowl"].error == pytest.approx(-2.0)
    errors = [fmean(values["left"]) - 100, -2.0]
    left, right = found.devices
    assert (left.device, left.objects, left.values) == ("left", 2, 10)
    assert left.bias == pytest.approx(np.mean(errors))
    assert left.rms == pytest.approx(np.sqrt(np.mean(np.square(errors))))
    assert right.bias == pytest.approx(fmean(values["right"]) - 100)
    assert found.between_sd("lab", "cup") == pytest.approx(stdev([fmean(one) for one in values.values()]))
    assert found.between_sd("lab", "bowl") is None


def test_private_values_count_for_their_owner_only(store: Store) -> None:
    """Means and counts are of what somebody sees."""
    store.put_many([weighed(1, CUP, "left", 10.0), weighed(3, CUP, "left", 30.0, visibility="private", owner="ann")])
    (public,) = agreements(store, Viewer(), "mass").cells
    (own,) = agreements(store, Viewer("ann"), "mass").cells
    assert (public.count, public.mean, own.count, own.mean) == (1, 10.0, 2, 20.0)
    assert agreements(store, Viewer(), "length").cells == ()
