"""The contract of a robot, as tests: inherit from `RobotContract` and say how to make yours.

A whole test file of an implementation::

    class TestMyRobot(RobotContract):
        network = palpate.load_network("household")

        def make_robot(self):
            return MyRobot("/dev/ttyUSB0")
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import ClassVar, get_args

from palpate.network.admission import admit
from palpate.network.model import Network
from palpate.outcomes import Outcome
from palpate.robots.protocol import Robot

__all__ = ["RobotContract"]

NO_ACTION = "no robot can do this"


class RobotContract:
    """Tests that every robot passes; pytest collects them in a subclass whose name begins with Test.

    Attributes
    ----------
    network
        The network the robot is meant for; None leaves out the tests that need it.
    """

    network: ClassVar[Network | None] = None

    def make_robot(self) -> Robot:
        """Make a robot that is ready to act, a new one at each call."""
        raise NotImplementedError("a contract test needs make_robot() to return a new robot")

    def test_it_is_a_robot(self) -> None:
        """A robot has the two methods of the protocol."""
        assert isinstance(self.make_robot(), Robot)

    def test_actions_are_distinct_names(self) -> None:
        """The actions are a sequence of distinct names, at least one when the robot is new."""
        actions = self.make_robot().actions()
        assert isinstance(actions, Sequence)
        assert not isinstance(actions, str), "actions() must return a sequence of names, not one name"
        assert actions, "a new robot must have something to do"
        assert all(isinstance(name, str) for name in actions)
        assert len(set(actions)) == len(actions), f"actions() names an action twice: {list(actions)}"

    def test_asking_changes_nothing(self) -> None:
        """Asking for the actions twice gives the same answer."""
        robot = self.make_robot()
        assert list(robot.actions()) == list(robot.actions())

    def test_each_action_returns_an_outcome(self) -> None:
        """Each action on offer returns an outcome, a failed one included, and does not raise."""
        robot = self.make_robot()
        for action in tuple(robot.actions()):
            outcome = robot.perform(action)
            assert isinstance(outcome, get_args(Outcome)), f"{action!r} returned {outcome!r}, which is no outcome"

    def test_outcomes_fit_the_network(self) -> None:
        """Each action is one of the network's, and the network admits its outcome."""
        if self.network is None:
            return
        robot = self.make_robot()
        for action in tuple(robot.actions()):
            admit(self.network, action, robot.perform(action))

    def test_unknown_action_is_no_outcome(self) -> None:
        """An action that is not on offer raises, and gives no outcome."""
        robot = self.make_robot()
        try:
            outcome = robot.perform(NO_ACTION)
        except Exception as error:
            told = str(error)
        else:
            raise AssertionError(f"an unknown action gave {outcome!r}, expected an error")
        assert told, "the error must say what was wrong"
