from typing import Any

import pytest

from palpate.errors import EvidenceError
from palpate.inference.exact import ExactBelief
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.model import Action
from palpate.network.reading import load_network
from palpate.network.sensors import NumberSensor
from palpate.outcomes import Failed, Label, Reading
from palpate.robots.contract import RobotContract
from palpate.robots.protocol import FunctionRobot, Robot
from palpate.robots.trial import attempt


class TestFunctionRobot(RobotContract):
    """A robot made of functions keeps the contract."""

    network = load_network("household")

    def make_robot(self) -> Any:
        return FunctionRobot({"weighing": lambda: Reading(118.0, unit="g")})


def test_a_new_action_joins_a_robot() -> None:
    """A function adds an action to a robot, or replaces one, and all others stay."""
    arm = FunctionRobot({"look": lambda: Label("mug"), "weigh": lambda: Reading(1.0)})
    robot = FunctionRobot({"knock": lambda: Label("wood"), "weigh": lambda: Reading(2.0)}, beside=arm)
    assert robot.actions() == ("knock", "weigh", "look")
    assert robot.perform("weigh") == Reading(2.0)
    assert robot.perform("look") == Label("mug")
    assert isinstance(robot, Robot)


def test_a_new_action_takes_ten_lines() -> None:
    """A new action is a name, a cost, a sensor model and a function; the gain of it is there at once."""
    network = load_network("household").with_action(
        Action("dipping", cost_s=30.0, sensor=NumberSensor("volume", sd=2.0)),
    )
    robot = FunctionRobot({"dipping": lambda: Reading(52.0, unit="cm^3")})
    belief = ExactBelief(network).update("dipping", robot.perform("dipping"))
    volume = belief.marginal("volume")
    assert isinstance(volume, ContinuousMarginal)
    assert volume.mean == pytest.approx(52.0, abs=2.0)


def test_an_unknown_action_is_an_error() -> None:
    """A robot of functions names what it can do."""
    with pytest.raises(EvidenceError, match="unknown action 'fly': choose from 'weigh'"):
        FunctionRobot({"weigh": lambda: Reading(1.0)}).perform("fly")


def test_a_contract_without_a_robot_is_told() -> None:
    """Whoever forgets make_robot is told what to write."""
    with pytest.raises(NotImplementedError, match=r"make_robot\(\)"):
        RobotContract().make_robot()


def weigh_without_unit() -> Any:
    return 118.0


@pytest.mark.parametrize(
    ("robot", "test"),
    [
        (FunctionRobot({}), "test_actions_are_distinct_names"),
        (FunctionRobot({"fly": lambda: Reading(1.0)}), "test_outcomes_fit_the_network"),
        (FunctionRobot({"weighing": weigh_without_unit}), "test_each_action_returns_an_outcome"),
        (object(), "test_it_is_a_robot"),
    ],
)
def test_the_contract_finds_a_bad_robot(robot: Any, test: str) -> None:
    """Each part of the contract fails for a robot that breaks it."""

    class Contract(RobotContract):
        network = load_network("household")

        def make_robot(self) -> Any:
            return robot

    with pytest.raises((AssertionError, EvidenceError)):
        getattr(Contract(), test)()


def test_the_contract_finds_a_robot_that_does_anything() -> None:
    """A robot that gives an outcome for an unknown action breaks the contract."""

    class Yes:
        def actions(self) -> Any:
            return ("weighing",)

        def perform(self, action: str) -> Any:
            return Failed()

    class Contract(RobotContract):
        def make_robot(self) -> Any:
            return Yes()

    Contract().test_outcomes_fit_the_network()
    with pytest.raises(AssertionError, match="an unknown action gave"):
        Contract().test_unknown_action_is_no_outcome()


def test_a_try_within_its_time_returns_the_outcome() -> None:
    """With and without a time limit the outcome is the robot's."""
    robot = FunctionRobot({"weigh": lambda: Reading(1.0)})
    assert attempt(robot, "weigh") == attempt(robot, "weigh", 5.0) == Reading(1.0)
