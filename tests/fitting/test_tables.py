"""Tables of probabilities from counts: closed forms and laws."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from palpate.fitting.data import Specimen
from palpate.fitting.tables import dirichlet_mean, looks, state_counts
from palpate.network.properties import CategoricalProperty
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Label
from tests.fitting.made_up import network_of

counts = npst.arrays(
    np.int64, npst.array_shapes(min_dims=1, max_dims=3, min_side=1, max_side=5), elements=st.integers(0, 50)
)


def test_by_hand() -> None:
    """(n_k + a) / (n + K a), row by row."""
    found = dirichlet_mean(np.array([[3, 1, 0], [0, 0, 0]]), 0.5)
    np.testing.assert_allclose(found, [[3.5 / 5.5, 1.5 / 5.5, 0.5 / 5.5], [1 / 3, 1 / 3, 1 / 3]])


@given(counts, st.floats(1e-3, 1e3))
def test_rows_sum_to_one_and_nothing_is_impossible(seen: np.ndarray, pseudo_count: float) -> None:
    """Every row is a distribution in which every state can occur."""
    found = dirichlet_mean(seen, pseudo_count)
    np.testing.assert_allclose(found.sum(axis=-1), 1)
    assert (found > 0).all()


@given(counts)
def test_smoothing_goes_from_frequencies_to_uniform(seen: np.ndarray) -> None:
    """A tiny pseudo-count gives the frequencies, a huge one the uniform distribution, and all between lie between."""
    uniform = np.full(seen.shape, 1 / seen.shape[-1])
    np.testing.assert_allclose(dirichlet_mean(seen, 1e12), uniform, atol=1e-9)
    total = seen.sum(axis=-1, keepdims=True)
    frequencies = np.where(total > 0, seen / np.maximum(total, 1), uniform)
    np.testing.assert_allclose(dirichlet_mean(seen, 1e-12), frequencies, atol=1e-9)
    distances = [np.abs(dirichlet_mean(seen, a) - uniform).sum() for a in (0.1, 1, 10)]
    assert distances == sorted(distances, reverse=True)


def test_state_counts_by_hand(tmp_path: Path) -> None:
    """Objects are counted by state and parents' states; those of which either is unknown are not."""
    network = network_of(tmp_path)
    metal = network.property("metal")
    assert isinstance(metal, CategoricalProperty)
    known = [{"kind": "bolt", "metal": "steel"}] * 3 + [
        {"kind": "nut", "metal": "zinc"},
        {"metal": "zinc"},
        {"kind": "nut"},
    ]
    specimens = [Specimen(str(place), truth) for place, truth in enumerate(known)]
    assert state_counts(network, metal, specimens).tolist() == [[3, 0, 0], [0, 0, 1]]


def test_looks_by_hand(tmp_path: Path) -> None:
    """Labels are counted by true state; those on objects whose state is unknown are not."""
    network = network_of(tmp_path)
    sensor = network.actions["look"].sensor
    assert isinstance(sensor, ConfusionSensor)
    seen = {"look": (Label("bolt"), Label("else"))}
    specimens = [Specimen("a", {"kind": "nut"}, seen), Specimen("b", {}, seen), Specimen("c", {"kind": "bolt"})]
    counted, weights = looks(network, "look", sensor, specimens)
    assert counted.tolist() == [[0, 0, 0], [1, 0, 1]]
    assert weights.tolist() == counted.tolist()


@pytest.mark.parametrize(("repeat", "share"), [(1.0, 0.1), (0.0, 1.0), (0.5, 1 / (1 + 9 / 4))])
def test_looks_that_repeat_each_other_count_less(tmp_path: Path, repeat: float, share: float) -> None:
    """Ten looks at one object that always repeat one label are one look; independent ones are ten."""
    network = network_of(tmp_path)
    sensor = ConfusionSensor("kind", ("bolt", "nut"), np.eye(2), repeat)
    specimens = [Specimen("a", {"kind": "nut"}, {"look": (Label("nut"),) * 10})]
    counted, weights = looks(network, "look", sensor, specimens)
    assert counted[1, 1] == 10
    assert weights[1, 1] == pytest.approx(10 * share)


def test_the_design_effect_is_that_of_the_sensor_model() -> None:
    """The variance of the share of a label over n looks is that of n / (1 + (n - 1) r^2) independent looks."""
    rng, n, r, p, objects = np.random.default_rng(5), 6, 0.7, 0.3, 40_000
    hidden = rng.random((objects, 1)) < p
    fresh = rng.random((objects, n)) < p
    share = np.where(rng.random((objects, n)) < r, hidden, fresh).mean(axis=1)
    expected = p * (1 - p) * (1 + (n - 1) * r * r) / n
    assert share.var() == pytest.approx(expected, rel=5 * np.sqrt(2 / objects) * 2)
