from typing import Any

import numpy as np
import pytest

from palpate.errors import EvidenceError
from palpate.explore import explore
from palpate.inference.exact import ExactBelief
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Label, Outcome, Posterior, Reading
from palpate.robots.contract import RobotContract
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.robot import MujocoRobot
from palpate.robots.signals import ImageSignals, SoundSignals, SqueezeSignals, WeighSignals

NETWORK = load_network("household")


# Estimates as simple as can be; the point here is the robot.
def mass(signals: WeighSignals) -> Outcome:
    if not signals.holds_something:
        return Failed("nothing between the fingers")
    hold = signals.holds[0]
    return Reading(1e3 * (hold.torque_nm.mean() - hold.empty_torque_nm.mean()) / (9.80665 * hold.lever_m), unit="g")


def stiffness(signals: SqueezeSignals) -> Outcome:
    touched = signals.force_n > 0.25 * signals.force_n.max()
    if touched.sum() < 8:
        return Failed("no contact")
    slope = -np.polyfit(signals.gap_mm[touched], signals.force_n[touched], 1)[0]
    return Reading(1e3 * slope * signals.rest_width_mm / signals.contact_area_mm2, unit="kPa")


def pitch(signals: SoundSignals) -> Outcome:
    return Label("metal" if np.abs(signals.samples[-4410:]).max() > 0.02 else "wood")


def colour(signals: ImageSignals) -> Outcome:
    red = signals.image[200:280, 280:360, 0].mean()
    return Posterior({"fruit": float(red / 255), "mug": float(1 - red / 255)})


ESTIMATES: dict[str, Any] = {"squeezing": stiffness, "weighing": mass, "mat-sound": pitch, "cat-vision": colour}


@pytest.mark.usefixtures("drawing")
class TestMujocoRobot(RobotContract):
    """A robot on the bench keeps the contract."""

    network = NETWORK

    def make_robot(self) -> MujocoRobot:
        return MujocoRobot.of(NETWORK, "banana_ycb", ESTIMATES, rng=np.random.default_rng(1))


def test_readings_are_near_the_truth() -> None:
    """Weighed and squeezed with all noise, the plastic banana is near its 66 g and 55 kPa."""
    with MujocoRobot.of(NETWORK, "banana_ycb", ESTIMATES, rng=np.random.default_rng(2)) as robot:
        weighed, squeezed = robot.perform("weighing"), robot.perform("squeezing")
    assert isinstance(weighed, Reading)
    assert isinstance(squeezed, Reading)
    assert weighed.value == pytest.approx(66, abs=8)
    assert squeezed.value == pytest.approx(55, abs=10)


def test_an_exploration_runs_and_its_signals_are_kept(drawing: None) -> None:
    """Each of the actions can be taken in an exploration, and its raw signals are handed on."""
    kept: dict[str, tuple[object, Outcome]] = {}

    def keep(action: str, signals: object, outcome: Outcome) -> None:
        kept[action] = (signals, outcome)

    with MujocoRobot.of(NETWORK, "ceramic_mug", ESTIMATES, rng=np.random.default_rng(3), record=keep) as robot:
        steps = [step for step in explore(ExactBelief(NETWORK), robot) if step.action]
    assert {step.action for step in steps} <= set(ESTIMATES)
    assert {action: outcome for action, (_, outcome) in kept.items()} == {step.action: step.outcome for step in steps}
    assert len(steps) >= 3


def test_the_seed_decides_the_outcomes() -> None:
    """Two robots with one seed return the same outcomes in the same order."""
    found = []
    for _ in range(2):
        with MujocoRobot.of(NETWORK, "soft_brick_ycb", ESTIMATES, rng=np.random.default_rng(7)) as robot:
            found.append([robot.perform(action) for action in ("weighing", "squeezing", "weighing", "mat-sound")])
    assert found[0] == found[1]
    assert found[0][0] != found[0][2]


def test_actions_that_cannot_be_done_are_named() -> None:
    """What the bench cannot do, and what the robot has no skill for, are errors with the choices."""
    with pytest.raises(BenchError, match=r"the bench cannot do action 'weighting' \(did you mean 'weighing'\?\)"):
        MujocoRobot.of(NETWORK, "banana", {"weighting": mass})
    with (
        MujocoRobot.of(NETWORK, "banana", {"weighing": mass}) as robot,
        pytest.raises(EvidenceError, match="unknown action 'squeezing': choose from 'weighing'"),
    ):
        robot.perform("squeezing")
