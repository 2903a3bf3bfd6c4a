"""What a robot measured, as data that networks are fitted to."""

from dataclasses import replace

import pytest

from palpate.fitting.errors import FittingError
from palpate.fitting.robot_data import Measured, most_probable, read_outcomes
from palpate.network.reading import load_network
from palpate.outcomes import Above, Failed, Label, Likelihood, Outcome, Posterior, Reading

NETWORK = load_network("household")


def read(*measured: tuple[str, str, Outcome]):
    return read_outcomes(NETWORK, NETWORK.objects, [Measured(*one) for one in measured], "a robot")


def test_truth_and_readings_of_the_objects_that_were_measured() -> None:
    """Only they are there, with what is known of them; units are the network's, vectors their top label."""
    data = read(
        ("ceramic_mug", "weighing", Reading(0.33, unit="kg")),
        ("ceramic_mug", "squeezing", Above(95.0, unit="kPa")),
        ("ceramic_mug", "mat-sound", Posterior({"glass": 0.3, "ceramic": 0.6, "wood": 0.1})),
        ("ceramic_mug", "mat-sound", Label("metal")),
    )
    (mug,) = data.specimens
    assert mug.name == "ceramic_mug"
    assert mug.truth["material"] == "ceramic"
    assert mug.readings["weighing"] == (Reading(330.0),)
    assert mug.readings["squeezing"] == (Above(95.0),)
    assert mug.readings["mat-sound"] == (Label("ceramic"), Label("metal"))
    assert data.sources[0].items == 4


def test_stand_ins_are_no_truth() -> None:
    """A material that is a stand-in is not known, as it is not scored."""
    (banana,) = read(("banana", "mat-sound", Label("foam"))).specimens
    assert "material" not in banana.truth
    assert banana.truth["category"] == "fruit"


def test_a_camera_is_not_calibrated_on_what_looks_like_something_else() -> None:
    """Tricks are left out for actions that see the appearance, and only for these."""
    data = read(("banana_ycb", "mat-vision", Label("foam")), ("banana_ycb", "mat-sound", Label("soft-plastic")))
    assert data.specimens[0].readings == {"mat-sound": (Label("soft-plastic"),)}
    assert data.notices == ("mat-vision: banana_ycb looks like banana; left out",)


def test_what_cannot_be_used_is_told() -> None:
    """Failures, labels that are none and actions that the network has not are counted in the notices."""
    data = read(
        ("banana", "weighing", Failed("it fell")),
        ("banana", "weighing", Failed("it fell again")),
        ("banana", "cat-vision", Label("pear")),
        ("banana", "licking", Label("sweet")),
    )
    assert data.specimens[0].readings == {}
    told = " | ".join(data.notices)
    assert "weighing: failed on banana 2 times, at first with: it fell; left out" in told
    assert "weighing: failed 2 of 2 times, at first with: it fell" in told
    assert "unknown label 'pear'" in told
    assert "'licking', which the network has not" in told


def test_failures_on_many_objects_are_told_in_short() -> None:
    """Those with most failures are named with a reason, and how many others there are."""
    things = list(NETWORK.objects)[:8]
    rows = [
        (name, "weighing", Failed(f"fell off {name}")) for place, name in enumerate(things) for _ in range(place + 1)
    ]
    told = [notice for notice in read(*rows).notices if "failed on" in notice]
    assert len(told) == 6
    assert f"weighing: failed on {things[7]} 8 times, at first with: fell off {things[7]}; left out" in told
    assert "weighing: failed on 3 more objects, 6 times; left out" in told


def test_an_unknown_object_is_refused() -> None:
    """Without truth there is nothing to compare with."""
    with pytest.raises(FittingError, match="'pear' is not known; choose from 'banana'"):
        read(("pear", "weighing", Reading(150.0)))


def test_the_digest_of_a_source_does_not_depend_on_the_order() -> None:
    """The same outcomes in another order are the same data; another outcome is not."""
    one, two = ("banana", "weighing", Reading(118.0)), ("ceramic_mug", "weighing", Reading(331.0))
    assert read(one, two).sources == read(two, one).sources
    assert read(one, two).sources != read(one, (*two[:2], Reading(332.0))).sources


@pytest.mark.parametrize("outcome", [Reading(1.0), Label("a"), Failed("no"), Above(2.0)])
def test_only_vectors_become_labels(outcome: Outcome) -> None:
    """All else stays as it is."""
    assert most_probable(outcome) is outcome
    assert most_probable(Likelihood({"a": 0.1, "b": 0.9})) == Label("b")


def test_a_network_without_objects_knows_none() -> None:
    """The message names no object where there are none."""
    with pytest.raises(FittingError, match="not known"):
        read_outcomes(replace(NETWORK, objects={}), {}, [Measured("banana", "weighing", Reading(1.0))], "a robot")
