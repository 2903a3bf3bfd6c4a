"""Worlds that are not as believed differ from the believed network in one respect."""

import numpy as np
import pytest

import palpate
from palpate.experiments.comparison.changes import Change, Noise, PermutedConfusion, SkewedPrior
from palpate.network.sensors import ConfusionSensor, NumberSensor

NETWORK = palpate.load_network("household-filled")


@pytest.mark.parametrize("change", [Noise(4.0), PermutedConfusion(), SkewedPrior()])
def test_a_change_leaves_probabilities_and_the_believed_network(change: Change) -> None:
    """Columns of confusion matrices and priors still sum to one, and the network given is as it was."""
    before = NETWORK.actions["cat-vision"].sensor
    changed = change.apply(NETWORK)
    assert NETWORK.actions["cat-vision"].sensor is before
    for action in changed.actions.values():
        if isinstance(action.sensor, ConfusionSensor):
            assert action.sensor.table.sum(axis=0) == pytest.approx(1)
    for known in changed.categorical:
        assert known.table.sum(axis=-1) == pytest.approx(1)


def test_noise_scales_sensors_of_numbers_only() -> None:
    """Confusion matrices and saturation stay."""
    changed = Noise(0.5).apply(NETWORK)
    squeezing = changed.actions["squeezing"].sensor
    assert isinstance(squeezing, NumberSensor)
    assert (squeezing.sd, squeezing.high) == (5.0, 95.0)
    assert changed.actions["mat-sound"].sensor is NETWORK.actions["mat-sound"].sensor


def test_permuted_columns_are_those_of_the_neighbours() -> None:
    """Each state is seen as the one before it, the first as the last."""
    own, changed = (n.actions["mat-sound"].sensor for n in (NETWORK, PermutedConfusion().apply(NETWORK)))
    assert isinstance(own, ConfusionSensor)
    assert isinstance(changed, ConfusionSensor)
    assert np.array_equal(changed.table[:, 0], own.table[:, -1])
    assert np.array_equal(changed.table[:, 3], own.table[:, 2])


def test_a_skewed_prior_leaves_what_depends_on_it() -> None:
    """The first state is twice as probable as the second, and tables of dependent properties stay."""
    changed = SkewedPrior().apply(NETWORK)
    category, material = changed.categorical
    assert category.table[0] / category.table[1] == pytest.approx(2)
    assert material is NETWORK.properties["material"]
