"""A robot whose every action becomes a recording in a store."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from time import monotonic, sleep

from palpate.client import Receiver
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.outcomes import Above, Below, Outcome, Reading
from palpate.recording.measuring import About, Measuring
from palpate.recording.recorder import current_recording
from palpate.recording.spool import Spool
from palpate.recording.uploading import Sent, send
from palpate.recording.watching import Finished, finished_recordings
from palpate.robots.protocol import Robot
from palpate.store.records import Setup, ThingRef

__all__ = ["RecordedRobot"]

PATIENCE_S, PAUSE_S = 60.0, 0.05
"""How long somebody else may take to send a recording, as long as a server may take to answer, and between looks."""


class RecordedRobot:
    """Does what another robot does, and records each action: outcome, output, and whatever the robot tells.

    An action that records itself, with `palpate.recording.record`, is not recorded twice. Others can add signals,
    files and poses to their recording with `palpate.recording.current_recording`. Each recording is in the spool
    before it is sent, and is sent before the outcome is returned; where it cannot be sent it waits there.

    Parameters
    ----------
    robot
        The robot that acts.
    network
        Tells which property an action measures, and its unit.
    receiver
        The store, or a server that has one; None where recordings wait in the spool for somebody else to send them.
    thing
        The object that is explored.
    setup
        The devices; what the robot has as its ``setup`` unless given.
    about
        Whose the recordings are.
    spool
        Where recordings are until the store has them.
    notices
        What is odd about each of them, as that nothing was measured where a network was asked.

    Attributes
    ----------
    troubles
        Recordings that wait in the spool, and why.
    """

    def __init__(
        self,
        robot: Robot,
        network: Network,
        receiver: Receiver | None,
        *,
        thing: ThingRef,
        setup: Setup | None = None,
        about: About | None = None,
        spool: Spool | None = None,
        notices: Sequence[str] = (),
    ) -> None:
        own = getattr(robot, "setup", None)
        self.thing = thing
        self.setup = setup or (own if isinstance(own, Setup) else Setup())
        self.about = about or About()
        self.troubles: list[str] = []
        self._robot = robot
        self._network = network
        self._receiver = receiver
        self.spool = spool or Spool()
        self._notices = tuple(notices)
        self._step = 0
        self._recorded: str | None = None
        self._waiting: list[str] = []

    def actions(self) -> Sequence[str]:
        """What the robot can do."""
        return self._robot.actions()

    def perform(self, action: str) -> Outcome:
        """Let the robot do an action, and record it."""
        step = self._step
        with finished_recordings() as finished:
            try:
                return self._measured(action, step, finished)
            finally:
                for one in finished:
                    self._send(one, action, step)

    def end_step(self) -> str | None:
        """Digest of the recording of the action that was done since this was last asked; None where there is none.

        An action that ends later was given up, and its recording says so.
        """
        recorded, self._recorded = self._recorded, None
        self._step += 1
        return recorded

    def take_waiting(self) -> list[str]:
        """Names of the recordings that were left in the spool, as there is no receiver, since this was last asked."""
        # an action that was given up may end while this is asked
        count = len(self._waiting)
        taken, self._waiting[:count] = self._waiting[:count], []
        return taken

    def _measured(self, action: str, step: int, finished: list[Finished]) -> Outcome:
        measured = self._network.action(action).sensor.property
        measuring = Measuring(action, self.setup, self.thing, measured, self.about, (), self.spool)
        with measuring.one((), {}, superseded=lambda: _is_recorded(action, finished)) as returned:
            outcome = self._robot.perform(action)
            notices = self._notices if step == self._step else (*self._notices, "it came after it was given up")
            current_recording().notice(*notices)
            returned.value = self._with_unit(outcome, measured)
            return outcome

    def _with_unit(self, outcome: Outcome, name: str) -> Outcome:
        """A number without a unit is in that of the property."""
        measured = self._network.property(name)
        if isinstance(measured, CategoricalProperty) or not isinstance(outcome, Reading | Above | Below):
            return outcome
        return outcome if outcome.unit is not None else replace(outcome, unit=measured.unit)

    def _send(self, one: Finished, action: str, step: int) -> None:
        if self._receiver is None:
            self._waiting.append(one.name)
        else:
            sent = _sent(one, self._receiver)
            if sent.state not in ("sent", "known"):
                self.troubles.append(f"the recording {one.name} is {sent.state} in {one.spool.folder}: {sent.reason}")
                return
        if one.recording.action == action and step == self._step:
            self._recorded = one.recording.digest


def _sent(one: Finished, receiver: Receiver) -> Sent:
    """What became of a recording, though somebody else may be sending what is in the same spool."""
    end = monotonic() + PATIENCE_S
    while (sent := send(one.spool, one.name, receiver)) is None:
        if not one.spool.waits(one.name):
            return _sent_by_another(one)
        if monotonic() > end:
            return Sent(one.name, "waiting", f"somebody else has been sending it for {PATIENCE_S:g} s")
        sleep(PAUSE_S)
    return sent


def _sent_by_another(one: Finished) -> Sent:
    """What became of a recording that is gone; that it is in this store too is found when the step is put."""
    reason = one.spool.refused().get(one.name)
    return Sent(one.name, "known") if reason is None else Sent(one.name, "refused", reason)


def _is_recorded(action: str, finished: Sequence[Finished]) -> bool:
    """Whether the action has recorded itself."""
    return any(one.recording.action == action for one in finished)
