"""One try at an action: whatever goes wrong with the robot becomes a failed outcome."""

from __future__ import annotations

from queue import Empty, SimpleQueue
from threading import Thread

from palpate.outcomes import Failed, Outcome
from palpate.robots.protocol import Robot

__all__ = ["attempt"]


def attempt(robot: Robot, action: str, timeout_s: float | None = None) -> Outcome:
    """Let the robot do an action; what it raises, or that it takes too long, is a `Failed`.

    Only `Exception` is caught: an interrupt from the keyboard ends the exploration.

    Parameters
    ----------
    timeout_s
        Longest time to wait [s]; None waits for ever, and needs no thread.

    Examples
    --------
    >>> from palpate.robots.protocol import FunctionRobot
    >>> attempt(FunctionRobot({}), "weighing").reason
    "EvidenceError: unknown action 'weighing': choose from "
    """
    if timeout_s is None:
        return _perform(robot, action)
    answers: SimpleQueue[Outcome | BaseException] = SimpleQueue()
    # A daemon, so that a robot that never returns does not keep the program from ending.
    Thread(target=_answer, args=(robot, action, answers), name=f"palpate {action}", daemon=True).start()
    try:
        answer = answers.get(timeout=timeout_s)
    except Empty:
        return Failed(f"timed out after {timeout_s:g} s")
    if isinstance(answer, BaseException):
        raise answer
    return answer


def _perform(robot: Robot, action: str) -> Outcome:
    try:
        return robot.perform(action)
    except Exception as error:
        return Failed(f"{type(error).__name__}: {error}")


def _answer(robot: Robot, action: str, answers: SimpleQueue[Outcome | BaseException]) -> None:
    try:
        answers.put(_perform(robot, action))
    except BaseException as error:
        # not the robot's failure but an order to stop: it belongs to the thread that waits
        answers.put(error)
