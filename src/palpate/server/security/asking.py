"""Asking a provider that may be slow or away, so that those who do not need it are served meanwhile."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TypeVar

from palpate.errors import PalpateError

__all__ = ["Asking", "AwayError", "SignOnError"]

AT_ONCE = 4
"""Of the threads of a worker, which are for everybody."""
REST_S = 10.0
BUSY_S = 2.0
Answer = TypeVar("Answer")


class SignOnError(PalpateError):
    """Nobody is logged in, and why."""


class AwayError(SignOnError):
    """The provider does not answer, or too many ask it; when to try again [s]."""

    def __init__(self, told: str, retry_s: float = REST_S) -> None:
        super().__init__(told)
        self.retry_s = retry_s


class Asking:
    """Lets few ask at once, and nobody for some seconds after there was no answer; the others learn it at once.

    Each worker learns it for itself.

    Parameters
    ----------
    clock
        Tells the time [s].
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self._free = threading.BoundedSemaphore(AT_ONCE)
        self._away: tuple[float, str] | None = None

    def ask(self, ask: Callable[[], Answer]) -> Answer:
        """What `ask` gives.

        Raises
        ------
        AwayError
            Where it raises one, or did so a moment ago, or is asked by others.
        """
        now = self._clock()
        if self._away is not None and now < self._away[0]:
            raise AwayError(self._away[1], self._away[0] - now)
        if not self._free.acquire(blocking=False):
            raise AwayError("many log in at once, and the provider is slow; try again", BUSY_S)
        try:
            found = ask()
        except AwayError as error:
            self._away = (self._clock() + error.retry_s, str(error))
            raise
        finally:
            self._free.release()
        self._away = None
        return found
