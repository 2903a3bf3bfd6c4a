"""Message passing that is given the row of the confusion matrix for a label."""

import numpy as np
import pytest

import palpate
from palpate.experiments.comparison.vector_fed import VectorFed, VectorFedBelief
from palpate.inference.message_passing import MessagePassingBelief, Settings
from palpate.network.sensors import ConfusionSensor

NETWORK = palpate.load_network("household-filled")


def test_a_label_is_the_row_of_the_confusion_matrix() -> None:
    """The belief is that of message passing given the row, scaled or not, as a likelihood."""
    sensor = NETWORK.actions["mat-sound"].sensor
    assert isinstance(sensor, ConfusionSensor)
    row = sensor.table[sensor.outcomes.index("paper")]
    states = NETWORK.categorical[1].states
    vector = palpate.Likelihood(dict(zip(states, (3 * row).tolist(), strict=True)))
    plain = MessagePassingBelief(NETWORK).update("mat-sound", vector)
    fed = VectorFedBelief(NETWORK).update("mat-sound", palpate.Label("paper"))
    for name in ("category", "material"):
        assert fed.probabilities(name) == pytest.approx(plain.probabilities(name), abs=1e-12)


def test_numbers_are_read_as_ever() -> None:
    """A reading changes both beliefs alike."""
    reading = palpate.Reading(50.0)
    fed = VectorFed(Settings.repaired()).prior(NETWORK, seed=3).update("squeezing", reading)
    plain = MessagePassingBelief(NETWORK, Settings.repaired(), seed=3).update("squeezing", reading)
    assert np.array_equal(fed.probabilities("material"), plain.probabilities("material"))
    assert isinstance(fed, VectorFedBelief)
