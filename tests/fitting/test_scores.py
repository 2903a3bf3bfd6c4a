"""Log scores on held-out objects."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from palpate.fitting.data import Specimen
from palpate.fitting.errors import FittingError
from palpate.fitting.fit import fit
from palpate.fitting.scores import FLOOR, folds_of, held_out_scores, log2_property, log2_sensor
from palpate.fitting.settings import Settings
from palpate.fitting.store_data import read_store
from palpate.fitting.template import read_template
from palpate.network.admission import AdmittedOutcome
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.reading import load_network
from palpate.outcomes import Above, Label, Reading
from palpate.store.opening import open_store
from tests.fitting.made_up import drawn, fill, network_of, workshop, wrong_workshop
from tests.fitting.test_template import BLANK


def test_a_fit_beats_the_prior_on_held_out_objects(tmp_path: Path) -> None:
    """From a store of objects of a known world, every table scores better on held-out objects than the template's.

    Each difference, over 150 objects, is at least two standard errors above zero.
    """
    truth = network_of(tmp_path)
    template = read_template(wrong_workshop(tmp_path))
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        fill(store, truth, drawn(truth, 150, 1))
        data = read_store(store, template.network)
    scores = held_out_scores(template, data.specimens)
    assert len(scores) == 5 + 3
    for key, score in scores.items():
        assert score.against == "template", key
        assert score.objects == 150
        assert score.difference > 2 * score.se > 0, key


def test_the_fit_is_better_on_new_objects_too(tmp_path: Path) -> None:
    """What held-out scores promise holds: on new objects the differences are within five standard errors of them."""
    truth, template = network_of(tmp_path), read_template(wrong_workshop(tmp_path))
    specimens, fresh = drawn(truth, 150, 2), drawn(truth, 400, 3)
    scores, found = held_out_scores(template, specimens), fit(template, specimens).network
    for name in ("density", "volume", "metal"):
        one, other = found.property(name), template.network.property(name)
        assert isinstance(one, CategoricalProperty | ContinuousProperty)
        assert isinstance(other, CategoricalProperty | ContinuousProperty)
        differences = [log2_property(found, one, s) - log2_property(truth, other, s) for s in fresh]
        promised = scores["property", name]
        error = np.hypot(promised.se, np.std(differences) / np.sqrt(len(fresh)))
        assert np.mean(differences) == pytest.approx(promised.difference, abs=5 * error)


def test_parents_that_tell_something_pay(tmp_path: Path) -> None:
    """Where the template has no numbers, properties are compared with themselves without parents; here parents help."""
    scores = held_out_scores(read_template(workshop(tmp_path, BLANK)), drawn(network_of(tmp_path), 120, 4))
    for name in ("metal", "density", "volume"):
        score = scores["property", name]
        assert score.against == "without parents"
        assert score.difference > 2 * score.se
    assert scores["action", "weigh"].against == ""
    assert math.isnan(scores["action", "weigh"].difference)
    assert scores["property", "hardness"].difference == 0


@pytest.fixture
def network(tmp_path: Path) -> Network:
    return network_of(tmp_path)


def test_scores_by_hand(network: Network) -> None:
    """Scores are log2 of probabilities, densities, and of the probability beyond a bound, by reading."""
    truth: dict[str, str | float] = {"kind": "nut", "metal": "brass", "density": 8.4, "volume": 1.1, "mass": 30.0}
    readings: dict[str, tuple[AdmittedOutcome, ...]] = {
        "look": (Label("nut"), Label("else")),
        "weigh": (Reading(31.0), Above(35.0)),
    }
    one = Specimen("a", truth, readings)
    metal, density = network.property("metal"), network.property("density")
    assert isinstance(metal, CategoricalProperty)
    assert isinstance(density, ContinuousProperty)
    assert log2_property(network, metal, one) == pytest.approx(math.log2(0.5))
    assert log2_property(network, density, one) == pytest.approx(stats.norm(8.5, 0.2).logpdf(8.4) / math.log(2))
    assert log2_sensor(network, network.actions["look"], one) == pytest.approx(math.log2(0.8 * 0.1) / 2)
    expected = (stats.norm(30, 2).logpdf(31) + stats.norm(30, 2).logsf(35)) / math.log(2) / 2
    assert log2_sensor(network, network.actions["weigh"], one) == pytest.approx(expected)
    assert log2_sensor(network, network.actions["scratch"], one) is None


def test_an_impossible_state_has_a_floor(network: Network) -> None:
    """A table that says never is not infinitely wrong."""
    metal = network.property("metal")
    assert isinstance(metal, CategoricalProperty)
    never = replace(metal, table=np.array([[1.0, 0, 0], [1.0, 0, 0]]))
    assert log2_property(network, never, Specimen("a", {"kind": "nut", "metal": "zinc"})) == math.log2(FLOOR)


def test_folds_hold_each_object_once(network: Network) -> None:
    """Folds are of nearly one size, hold each object once, and do not depend on the order of objects."""
    specimens = drawn(network, 23, 5, repeats=0)
    folds = folds_of(specimens, 5)
    assert sorted(len(fold) for fold in folds) == [4, 4, 5, 5, 5]
    assert sorted(one.name for fold in folds for one in fold) == [one.name for one in specimens]
    assert folds_of(specimens[::-1], 5) == folds
    assert len(folds_of(specimens[:3], 10)) == 3


def test_what_was_kept_is_not_scored(tmp_path: Path) -> None:
    """Numbers of the template that were kept are no fit, and have no score."""
    template = read_template(workshop(tmp_path))
    scores = held_out_scores(template, drawn(template.network, 30, 6), Settings(keep=("metal", "look")), folds=3)
    assert ("property", "metal") not in scores
    assert ("action", "look") not in scores
    assert ("property", "kind") in scores


def test_too_few_folds_or_objects(tmp_path: Path) -> None:
    """One fold is none, and a template without numbers needs data also where objects are held out."""
    blank, truth = read_template(workshop(tmp_path, BLANK)), load_network(workshop(tmp_path))
    with pytest.raises(FittingError, match="folds: found 1; expected 2 at least"):
        held_out_scores(blank, [], folds=1)
    with pytest.raises(
        FittingError, match=r"folds: with some objects held out, .*; expected more objects, or no folds"
    ):
        held_out_scores(blank, drawn(truth, 3, 7, repeats=1))


def test_progress_is_told(tmp_path: Path) -> None:
    """Who waits hears of each fold before it begins."""
    told: list[tuple[int, int]] = []
    template = read_template(workshop(tmp_path))
    held_out_scores(template, drawn(template.network, 9, 8), folds=3, told=lambda done, of: told.append((done, of)))
    assert told == [(0, 3), (1, 3), (2, 3)]


def test_a_slip_of_the_pen_is_not_scored(tmp_path: Path) -> None:
    """A value that the fit leaves out does not outweigh all others; the other objects are scored as ever."""
    template = read_template(wrong_workshop(tmp_path))
    first, *others = drawn(network_of(tmp_path), 60, 9)
    slipped = replace(
        first, truth={**first.truth, "volume": 1e5}, readings={**first.readings, "scratch": (Reading(99.0),)}
    )
    scores = held_out_scores(template, [slipped, *others], folds=3)
    for key in (("property", "volume"), ("action", "scratch")):
        assert scores[key].objects == 59
        assert scores[key].difference > 0
    assert scores["property", "density"].objects == 60
