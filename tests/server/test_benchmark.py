"""Devices against what is known, by hand and against the plain formulas."""

from statistics import fmean, stdev

import numpy as np
import pytest
from fastapi.testclient import TestClient

from palpate.server.benchmark import agreements, interval
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


def test_the_figures_of_a_benchmark_by_hand(store: Store) -> None:
    """Errors of 1, 3 and 5 g: mean 3, SD 2, root mean square sqrt(35 / 3); t of 2 degrees is 4.3027: 3 +- 4.968.

    An object of which no truth is known counts in the differences of the pair only: 1, 2, 3 and 92 g.
    """
    things = [ThingRef("lab", name) for name in ("one", "two", "three", "unknown")]
    number = 0
    for thing, of_left, of_right in zip(things, (1, 3, 5, 99), (0, 1, 2, 7), strict=True):
        # two values about each mean
        for gripper, off in (("left", of_left), ("right", of_right)):
            for step in (-0.5, 0.5):
                number += 1
                store.put(weighed(number, thing, gripper, 100 + off + step))
    for thing in things[:3]:
        change_thing(store, thing, lambda thing: thing.knowing(Value("mass", 100.0, unit="g"), "a scale"))
    found = agreements(store, Viewer(), "mass")
    left, right = found.devices
    assert (left.objects, left.values, left.known) == (4, 8, 3)
    assert (left.bias, left.sd) == pytest.approx((3.0, 2.0))
    assert left.rms == pytest.approx((35 / 3) ** 0.5)
    assert left.interval == pytest.approx((3 - 4.968, 3 + 4.968), abs=2e-3)
    assert (right.bias, right.sd) == pytest.approx((1.0, 1.0))
    (pair,) = found.differences()
    assert (pair.first, pair.second, pair.objects, pair.first_values, pair.second_values) == ("left", "right", 4, 8, 8)
    offs = [1.0, 2.0, 3.0, 92.0]
    assert (pair.mean, pair.sd) == pytest.approx((fmean(offs), stdev(offs)))
    assert interval([4.0]) is None


def test_the_benchmark_is_downloaded_as_it_is_shown(client: TestClient, store: Store) -> None:
    """CSV and JSON hold the same numbers; without a known value there is no row."""
    assert client.get("/benchmark/errors.csv").text.splitlines() == [
        "property,unit,device,objects,values,known,bias,sd,rms,low,high"
    ]
    store.put_many([weighed(1, CUP, "=left", 10.0), weighed(2, BOWL, "=left", 13.0)])
    for thing in (CUP, BOWL):
        change_thing(store, thing, lambda thing: thing.knowing(Value("mass", 9.0, unit="g"), "a scale"))
    (row,) = client.get("/benchmark/errors.json").json()["items"]
    assert (row["device"], row["known"], row["bias"]) == ("=left", 2, pytest.approx(2.5))
    _, line = client.get("/benchmark/errors.csv").text.splitlines()
    # no spreadsheet takes a name for a formula
    assert line.split(",")[:3] == ["mass", "g", "'=left"]
    assert [float(one) for one in line.split(",")[3:]] == pytest.approx([row[name] for name in NUMBERS])
    assert "2.5" in client.get("/benchmark").text


NUMBERS = ("objects", "values", "known", "bias", "sd", "rms", "low", "high")
