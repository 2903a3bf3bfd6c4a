"""The Robot protocol: two methods, and whatever has them is a robot."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Protocol, runtime_checkable

from palpate.errors import EvidenceError, choices, near
from palpate.outcomes import Outcome

__all__ = ["FunctionRobot", "Robot"]


@runtime_checkable
class Robot(Protocol):
    """Something that can measure an object; `palpate.robots.contract` tests an implementation."""

    def actions(self) -> Sequence[str]:
        """Names of the actions it can do now; asking changes nothing."""

    def perform(self, action: str) -> Outcome:
        """Do an action and return its outcome.

        Return `Failed`, or raise, where there is none: exploration records it and goes on.
        """


class FunctionRobot:
    """A robot made of functions, a function for each action; it can add them to another robot.

    Parameters
    ----------
    functions
        Action to a function without arguments that does it and returns the outcome.
    beside
        The robot that does all other actions.

    Examples
    --------
    >>> from palpate.outcomes import Reading
    >>> robot = FunctionRobot({"weighing": lambda: Reading(118.0, unit="g")})
    >>> robot.actions()
    ('weighing',)
    >>> robot.perform("weighing").value
    118.0
    """

    def __init__(self, functions: Mapping[str, Callable[[], Outcome]], beside: Robot | None = None) -> None:
        self._functions = dict(functions)
        self._beside = beside

    def actions(self) -> tuple[str, ...]:
        """Names of the functions' actions, then those of the robot beside."""
        others = self._beside.actions() if self._beside else ()
        return (*self._functions, *(name for name in others if name not in self._functions))

    def perform(self, action: str) -> Outcome:
        """Call the action's function, or let the robot beside do it.

        Raises
        ------
        EvidenceError
            If neither knows the action.
        """
        if action in self._functions:
            return self._functions[action]()
        if self._beside:
            return self._beside.perform(action)
        raise EvidenceError(f"unknown action {action!r}{near(action, self._functions)}: {choices(self._functions)}")
