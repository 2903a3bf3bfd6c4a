"""Whole networks fitted to objects drawn from a known one."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from palpate.explore import explore
from palpate.fitting.data import Specimen
from palpate.fitting.errors import FittingError
from palpate.fitting.fit import fit
from palpate.fitting.settings import Settings
from palpate.fitting.template import Template, read_template
from palpate.inference.exact import ExactBelief
from palpate.network.digest import digest
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor, NumberSensor
from palpate.robots.sampled import SampledRobot
from palpate.selection.objectives import Learn
from palpate.selection.stopping import StepBudget
from tests.fitting.made_up import drawn, workshop, wrong_workshop
from tests.fitting.test_template import BLANK


@pytest.fixture
def template(tmp_path: Path) -> Template:
    return read_template(workshop(tmp_path))


def test_the_truth_comes_back(tmp_path: Path) -> None:
    """From 800 objects, and a template without numbers, tables and sensors are within 4.5 errors of the truth."""
    truth = load_network(workshop(tmp_path))
    blank = read_template(workshop(tmp_path, BLANK))
    found = fit(blank, drawn(truth, 800, 1))
    for prop in truth.categorical:
        table = found.network.property(prop.name)
        assert isinstance(table, CategoricalProperty)
        counts = found.properties[prop.name].counts
        assert counts is not None
        error = np.sqrt(prop.table * (1 - prop.table) / counts.sum(axis=-1, keepdims=True))
        assert (np.abs(table.table - prop.table) < 4.5 * error + 0.002).all()
    look, true = found.network.actions["look"].sensor, truth.actions["look"].sensor
    assert isinstance(look, ConfusionSensor)
    assert isinstance(true, ConfusionSensor)
    looks = found.actions["look"].counts
    assert looks is not None
    assert looks.sum() == 1600
    error = np.sqrt(true.table * (1 - true.table) / looks.sum(axis=1))
    assert (np.abs(look.table - true.table) < 4.5 * error + 0.002).all()
    for name, sd in (("weigh", 2.0), ("scratch", 0.1)):
        sensor = found.network.actions[name].sensor
        assert isinstance(sensor, NumberSensor)
        exact = found.actions[name].readings - found.actions[name].saturated
        assert abs(np.log(sensor.sd / sd)) < 4.5 / np.sqrt(exact)


def test_columns_and_rows_sum_to_one(template: Template) -> None:
    """Every table and every column of a confusion matrix is a distribution to within 1e-8, as it is written."""
    found = fit(template, drawn(template.network, 40, 2)).network
    for prop in found.categorical:
        np.testing.assert_allclose(prop.table.sum(axis=-1), 1, atol=1e-8)
    look = found.actions["look"].sensor
    assert isinstance(look, ConfusionSensor)
    np.testing.assert_allclose(look.table.sum(axis=0), 1, atol=1e-8)


def test_the_order_of_objects_does_not_matter(template: Template) -> None:
    """Objects in any order give the same network to the last bit."""
    specimens = drawn(template.network, 50, 3)
    assert digest(fit(template, specimens).network) == digest(fit(template, specimens[::-1]).network)


def test_without_data_all_stays(template: Template) -> None:
    """No objects leave the template as it is, and say so."""
    found = fit(template, [])
    assert digest(found.network) == template.digest
    notes = {part.note for part in found.properties.values()} | {part.note for part in found.actions.values()}
    assert notes == {"as in the template: no data"}


def test_what_is_kept_stays(template: Template) -> None:
    """Properties and actions that are to be kept have the template's numbers, others do not."""
    specimens = drawn(template.network, 50, 4)
    found = fit(template, specimens, Settings(keep=("kind", "weigh")))
    assert found.network.property("kind") is template.network.property("kind")
    assert found.network.actions["weigh"] is template.network.actions["weigh"]
    assert found.network.property("metal") is not template.network.property("metal")
    assert found.properties["kind"].note == found.actions["weigh"].note == "as in the template: kept"


def test_a_sensor_that_was_never_tried_on_a_state(template: Template) -> None:
    """The column of a state without looks is uniform, and the note says how many there are."""
    specimens = [one for one in drawn(template.network, 40, 5) if one.truth["kind"] == "bolt"]
    found = fit(template, specimens)
    look = found.network.actions["look"].sensor
    assert isinstance(look, ConfusionSensor)
    np.testing.assert_allclose(look.table[:, 1], 1 / 3)
    assert found.actions["look"].note == "1 of 2 true states never tried: uniform"
    assert found.properties["metal"].note == "1 of 2 rows without objects: uniform"


def test_what_is_not_used_is_told(template: Template) -> None:
    """Values of objects whose parents are unknown, and readings of unknown properties, are counted in the notes."""
    specimens = drawn(template.network, 20, 6)
    bare = [Specimen("x", {"metal": "zinc", "density": 7.0}, specimens[0].readings)]
    found = fit(template, specimens + bare)
    assert found.properties["metal"].note == "not used: 1 of objects whose kind is not known"
    assert found.properties["density"].note == ""
    assert found.actions["look"].note == "not used: 2 of objects whose kind is not known"
    assert found.actions["weigh"].note == "not used: 2 of objects whose mass is not known"


def test_numbers_that_are_nowhere(tmp_path: Path) -> None:
    """What the template leaves out and the data do not say is an error that names it."""
    blank = read_template(workshop(tmp_path, BLANK))
    specimens = drawn(load_network(workshop(tmp_path)), 20, 7)
    dry = [replace(one, readings={}) for one in specimens]
    with pytest.raises(FittingError, match=r"look: found 0 readings; expected at least 3 on objects with known kind"):
        fit(blank, dry)
    with pytest.raises(
        FittingError, match=r"metal: found 0 values; expected at least 3 of objects with known kind and"
    ):
        fit(blank, [])
    one = [replace(specimens[0], readings={name: found[:1] for name, found in specimens[0].readings.items()})]
    with pytest.raises(FittingError, match=r"found 1 (value|reading); expected"):
        fit(blank, one)


def test_wrong_settings(template: Template) -> None:
    """A pseudo-count of zero, and keeping what is not there, are errors."""
    with pytest.raises(FittingError, match="pseudo-count: found 0; expected a number above 0"):
        Settings(pseudo_count=0)
    with pytest.raises(FittingError, match=r"keep: found 'wiegh' \(did you mean 'weigh'\?\); choose from"):
        fit(template, [], Settings(keep=("wiegh",)))


def test_exploring_with_the_fit_beats_exploring_with_the_prior(tmp_path: Path) -> None:
    """On new objects, beliefs after exploring by the fitted network have a lower cross-entropy than by the template's.

    The difference is at least two standard errors over 60 objects.
    """
    truth, template = load_network(workshop(tmp_path)), read_template(wrong_workshop(tmp_path))
    found = fit(template, drawn(truth, 150, 8)).network
    gains = []
    for seed, one in enumerate(drawn(truth, 60, 9, repeats=0)):
        before, after = (_bits(network, truth, one, seed) for network in (template.network, found))
        gains.append(before - after)
    assert np.mean(gains) > 2 * np.std(gains) / np.sqrt(len(gains))


def _bits(network: Network, truth: Network, one: Specimen, seed: int) -> float:
    """Cross-entropy of an object's metal after exploring it by a network [bits]."""
    robot = SampledRobot(truth, one.truth, np.random.default_rng(seed))
    steps = list(explore(ExactBelief(network), robot, objective=Learn("metal"), stopping=StepBudget(2)))
    metal = network.property("metal")
    assert isinstance(metal, CategoricalProperty)
    return float(-np.log2(steps[-1].after.probabilities("metal")[metal.states.index(str(one.truth["metal"]))]))
