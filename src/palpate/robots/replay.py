"""A robot that gives back what was recorded."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Self

from palpate.errors import EvidenceError, LogError, choices
from palpate.evidence import parse_item
from palpate.logfile import EPISODE_FORMAT, SESSION_FORMAT, read_lines
from palpate.outcomes import Outcome

__all__ = ["ReplayRobot"]


class ReplayRobot:
    """Returns recorded outcomes: those of each action in the order in which they were recorded.

    Parameters
    ----------
    recorded
        Actions with their outcomes, such as `Session.recorded` and `Episode.recorded` hold.

    Examples
    --------
    >>> from palpate.outcomes import Reading
    >>> robot = ReplayRobot([("weighing", Reading(66.0)), ("weighing", Reading(67.0))])
    >>> robot.perform("weighing").value, robot.actions()
    (66.0, ('weighing',))
    >>> robot.perform("weighing").value, robot.actions()
    (67.0, ())
    """

    def __init__(self, recorded: Iterable[tuple[str, Outcome]]) -> None:
        self._left = list(recorded)

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Make a robot from a session file or an episode log.

        Raises
        ------
        LogError
            The file cannot be read; the message names the file and the line.
        """
        recorded = []
        for line in read_lines(path, SESSION_FORMAT, EPISODE_FORMAT):
            if "outcome" in line.record:
                try:
                    recorded.append(parse_item(line.record["outcome"]))
                except EvidenceError as error:
                    raise LogError(f"{line.where}: 'outcome': {error}") from error
        return cls(recorded)

    def actions(self) -> tuple[str, ...]:
        """The actions of which an outcome is left, in recorded order."""
        return tuple(dict.fromkeys(action for action, _ in self._left))

    def perform(self, action: str) -> Outcome:
        """Return the action's next recorded outcome.

        Raises
        ------
        EvidenceError
            Nothing is left of the action.
        """
        for place, (name, outcome) in enumerate(self._left):
            if name == action:
                del self._left[place]
                return outcome
        raise EvidenceError(f"no recorded outcome of action {action!r} is left: {choices(self.actions())}")
