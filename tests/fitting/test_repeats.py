"""How often looks repeat a label."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.fitting.data import Specimen
from palpate.fitting.repeats import repeat_probability
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor
from palpate.outcomes import Label
from palpate.robots.sampled import SampledRobot

NETWORK = load_network("household")


def looked(r: float, objects: int, looks: int, seed: int) -> tuple[ConfusionSensor, list[Specimen]]:
    """Objects of all materials, looked at by a camera that repeats itself."""
    action = NETWORK.actions["mat-sound"]
    assert isinstance(action.sensor, ConfusionSensor)
    sensor = replace(action.sensor, repeat_probability=r)
    network, rng = NETWORK.with_action(replace(action, sensor=sensor)), np.random.default_rng(seed)
    states, found = list(network.categorical[1].states), []
    for place in range(objects):
        truth = {"material": states[place % len(states)]}
        robot = SampledRobot(network, truth, rng)
        labels = tuple(robot.perform("mat-sound") for _ in range(looks))
        found.append(Specimen(str(place), truth, {"mat-sound": labels}))  # type: ignore[dict-item]
    return action.sensor, found


@pytest.mark.parametrize("r", [0.0, 0.4, 0.8, 1.0])
def test_the_probability_is_found(r: float) -> None:
    """From looks drawn with it, r^2 comes out within 0.06."""
    sensor, specimens = looked(r, 400, 4, 1)
    found = repeat_probability(NETWORK, "mat-sound", sensor, specimens)
    assert found is not None
    assert found**2 == pytest.approx(r**2, abs=0.06)


def test_single_looks_and_single_objects_say_nothing() -> None:
    """Looks that were not repeated, and objects that are the only ones of their state, do not tell."""
    for sensor, specimens in (looked(0.5, 40, 1, 2), looked(0.5, 8, 5, 2)):
        assert repeat_probability(NETWORK, "mat-sound", sensor, specimens) is None


def test_labels_that_are_all_the_same_say_nothing() -> None:
    """Where a state always gives one label, there is nothing that repetition could explain."""
    sensor, _ = looked(0.5, 0, 1, 0)
    labels = (Label("glass"),) * 3
    same = [Specimen(str(place), {"material": "glass"}, {"mat-sound": labels}) for place in range(9)]
    assert repeat_probability(NETWORK, "mat-sound", sensor, same) is None
