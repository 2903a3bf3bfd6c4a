"""Devices against what is known, by hand and against the plain formulas."""

from statistics import fmean, stdev

import numpy as np
import pytest
from fastapi.testclient import TestClient

from palpate.server.benchmark import agreements, interval
from palpate.store.describing import change_thing
from palpate.store.entries import Bound, Entry, Interval, Value
from palpate.store.merging import merge_things
from palpate.store.records import Device, Recording, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_results import results_of
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


def test_objects_whose_results_are_mostly_bounds_do_not_count(client: TestClient, store: Store) -> None:
    """Nine values of 12 g and one bound, a tenth: 12 - 10 = 2. Of the bowl two of three are censored, of the box all.

    Of those that count the mean error is 2, of all it would be (2 - 5) / 2 = -1.5.
    """
    box = ThingRef("lab", "box")
    bound = Bound("mass", above=20.0, unit="g")
    results: list[tuple[ThingRef, Entry]] = [(CUP, Value("mass", 12.0, unit="g"))] * 9 + [(CUP, bound)]
    results += [(BOWL, Value("mass", 5.0, unit="g")), (BOWL, bound), (BOWL, Interval("mass", 9.0, 30.0, "g"))]
    results += [(box, bound), (box, bound)]
    for number, (thing, entry) in enumerate(results, 1):
        store.put(weighed(number, thing, "left", 0.0, entries=(entry,)))
    store.put_many([weighed(50, CUP, "right", 13.0), weighed(51, BOWL, "right", 10.0)])
    # a bound that is not seen is not counted, and one that tells the truth is no measurement
    hidden = {"visibility": "private", "owner": "ann"}
    store.put_many([weighed(60, CUP, "left", 0.0, entries=(bound,), **hidden)])
    store.put_many([weighed(61, CUP, "left", 0.0, entries=(bound,), ground_truth=True)])
    for thing in (CUP, BOWL, box):
        change_thing(store, thing, lambda thing: thing.knowing(Value("mass", 10.0, unit="g"), "a scale"))
    found = agreements(store, Viewer(), "mass")
    cells = {(cell.device, cell.thing): cell for cell in found.cells}
    assert [
        (one.count, one.censored, one.mean, one.error)
        for one in (cells["left", thing.id] for thing in (CUP, BOWL, box))
    ] == [
        (9, 1, 12.0, 2.0),
        (1, 2, 5.0, None),
        (0, 2, None, None),
    ]
    left, _ = found.devices
    assert (left.objects, left.values, left.censored, left.known, left.left_out) == (3, 10, 5, 1, 2)
    assert (left.bias, left.rms) == pytest.approx((2.0, 2.0))
    (pair,) = found.differences()
    assert (pair.objects, pair.first_values, pair.mean) == pytest.approx((1, 9, -1.0))
    assert found.between_sd("lab", "bowl") is None
    assert agreements(store, Viewer("ann"), "mass").devices[0].left_out == 3
    row = client.get("/benchmark/errors.json").json()["items"][0]
    assert (row["bounds_only"], row["left_out"]) == (5, 2)
    assert "left out of that device" in client.get("/benchmark").text
    page = client.get("/compare?property=mass").text
    assert page.count(">left out<") == 1
    lines = client.get("/compare/table.csv?property=mass").text.splitlines()
    assert "left,lab,box,g,0,2,,,10.0," in lines


def test_the_benchmark_is_downloaded_as_it_is_shown(client: TestClient, store: Store) -> None:
    """CSV and JSON hold the same numbers; without a known value there is no row."""
    assert client.get("/benchmark/errors.csv").text.splitlines() == [
        "property,unit,device,objects,values,bounds_only,known,left_out,bias,sd,rms,low,high"
    ]
    store.put_many([weighed(1, CUP, "=left", 10.0), weighed(2, BOWL, "=left", 13.0)])
    for thing in (CUP, BOWL):
        change_thing(store, thing, lambda thing: thing.knowing(Value("mass", 9.0, unit="g"), "a scale"))
    (row,) = client.get("/benchmark/errors.json").json()["items"]
    assert (row["device"], row["known"], row["bias"]) == ("=left", 2, pytest.approx(2.5))
    page = client.get("/benchmark").text
    for name in ("known", "bias", "rms", "low", "high"):
        assert f"<code>{name}</code>" in page
    _, line = client.get("/benchmark/errors.csv").text.splitlines()
    # no spreadsheet takes a name for a formula
    assert line.split(",")[:3] == ["mass", "g", "'=left"]
    assert [float(one) for one in line.split(",")[3:]] == pytest.approx([row[name] for name in NUMBERS])
    assert "2.5" in client.get("/benchmark").text


NUMBERS = ("objects", "values", "bounds_only", "known", "left_out", "bias", "sd", "rms", "low", "high")


def test_results_known_to_be_in_a_wrong_unit_are_neither_drawn_nor_counted(client: TestClient, store: Store) -> None:
    """Nine values in kPa and one of each kind in g: no value is 5e-05 kPa, and no bound takes the device out."""
    stiff = {"action": "squeezing", "entries": (Value("stiffness", 50.0, unit="kPa"),)}
    store.put_many([weighed(number, CUP, "left", 0.0, **stiff) for number in range(1, 10)])
    odd = (
        Value("stiffness", 50.0, 1.0, "g"),
        Bound("stiffness", above=3.0, unit="g"),
        Interval("stiffness", 1, 2, "g"),
    )
    wrong = [weighed(20 + place, CUP, "left", 0.0, entries=(entry,)) for place, entry in enumerate(odd)]
    store.put_many(wrong, known_wrong=[one.digest for one in wrong])
    change_thing(store, CUP, lambda thing: thing.knowing(Value("stiffness", 40.0, unit="kPa"), "a scale"))
    results = [one for one in results_of(store, Viewer(), CUP) if one.recording in {one.id for one in wrong}]
    assert [(one.value, one.sd, one.low, one.high, one.unit) for one in results] == [(None,) * 5] * 3
    (left,) = agreements(store, Viewer(), "stiffness").devices
    assert (left.values, left.censored, left.known) == (9, 0, 1)
    assert left.bias == pytest.approx(10.0)
    assert "5e-05" not in client.get("/objects/lab/cup").text


def test_what_is_known_of_an_object_counts_after_it_is_merged(client: TestClient, store: Store) -> None:
    """90 g said of the copy are the truth of the cup that it counts as, until somebody says it of the cup itself."""
    store.put_many([weighed(1, COPY, "left", 100.0), weighed(2, CUP, "left", 102.0)])
    change_thing(store, COPY, lambda thing: thing.knowing(Value("mass", 90.0, unit="g"), "our scale"))
    assert agreements(store, Viewer(), "mass").devices[0].bias == pytest.approx(10.0)
    merge_things(store, COPY, CUP)
    assert agreements(store, Viewer(), "mass").devices[0].bias == pytest.approx(11.0)
    page = client.get("/objects/lab/cup").text
    assert "our scale" in page
    assert "true: 90" in page
    change_thing(store, CUP, lambda thing: thing.knowing(Value("mass", 91.0, unit="g"), "another scale"))
    assert agreements(store, Viewer(), "mass").devices[0].bias == pytest.approx(10.0)
    assert "our scale" not in client.get("/objects/lab/cup").text


def test_what_is_known_of_an_object_that_is_not_seen_is_told_to_nobody(client: TestClient, store: Store) -> None:
    """The copy is private: its truth, and where it is from, are its owner's only."""
    own = {"visibility": "private", "owner": "ann"}
    store.put_many([weighed(1, COPY, "left", 100.0, **own), weighed(2, CUP, "left", 102.0)])
    change_thing(store, COPY, lambda thing: thing.knowing(Value("mass", 90.0, unit="g"), "our scale"))
    merge_things(store, COPY, CUP)
    assert agreements(store, Viewer(), "mass").devices[0].bias is None
    assert agreements(store, Viewer("ann"), "mass").devices[0].bias == pytest.approx(11.0)
    assert "our scale" not in client.get("/objects/lab/cup").text
