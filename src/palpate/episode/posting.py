"""Sending an exploration to a server, with a recording of each action, while it runs."""

from __future__ import annotations

from uuid import UUID

from palpate.episode.format import About
from palpate.episode.keeping import begun_episode, stored_record
from palpate.explore import Step
from palpate.inference.belief import Belief
from palpate.recording.posting import Left, Poster, Server
from palpate.robots.recorded import RecordedRobot
from palpate.store.episodes import StoredStep

__all__ = ["PostedEpisode"]

PATIENCE_S = 5.0


class PostedEpisode:
    """An episode that goes to a server, a step at a time, without ever waiting for it.

    Steps and recordings are on this computer's disk, in the robot's spool, before they are sent. A server that is
    away, slow, or refuses changes nothing for the exploration; what it does not have in the end stays in the spool,
    and ``palpate spool upload --to`` sends it.

    Parameters
    ----------
    server
        Where it goes, such as a `palpate.Client`.
    robot
        The robot that explores, made without a receiver: its recordings go where the episode goes.
    belief
        The belief at the start.
    about
        How the exploration is set up.

    Examples
    --------
    ::

        robot = RecordedRobot(own_robot, network, None, thing=ThingRef("our lab", "sponge 3"))
        posted = PostedEpisode(palpate.Client("https://measurements.example.org/api/v1"), robot, belief)
        for step in explore(belief, robot):
            posted.write(step)
        left = posted.close()
    """

    def __init__(self, server: Server, robot: RecordedRobot, belief: Belief, about: About | None = None) -> None:
        self._robot = robot
        self.stored = begun_episode(robot, belief, about)
        self._poster = Poster(robot.spool, server, self.stored)

    @property
    def id(self) -> UUID:
        """Under which id the server has it."""
        return self.stored.id

    def begun(self, patience_s: float) -> Left | None:
        """Wait a little for the server to take its beginning; None where it has, else why it has not."""
        return self._poster.begun(patience_s)

    def write(self, step: Step) -> None:
        """Add a step; RecordingError if this computer's disk does not take it."""
        line = StoredStep(stored_record(step), self._robot.end_step())
        self.stored = self.stored.continued(line.record, line.recording)
        self._poster.add(line, self._robot.take_waiting())

    def close(self, patience_s: float | None = None) -> Left | None:
        """Wait a little, 5 s unless told, for what is under way; what the server lacks then, None where it has all."""
        return self._poster.close(PATIENCE_S if patience_s is None else patience_s)
