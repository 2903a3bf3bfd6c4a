"""Sending an exploration to a server while it runs, in a thread of its own: whoever explores waits for nobody."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from queue import SimpleQueue
from typing import Protocol
from uuid import UUID

from palpate.client import BackOff, Receiver, ReceiverError, UnreachableError, asked_s, once
from palpate.recording.outbox import Outbox
from palpate.recording.spool import Spool
from palpate.recording.uploading import attempt
from palpate.store.episodes import StoredEpisode, StoredStep
from palpate.store.errors import StoreError, UnavailableError

__all__ = ["Left", "Poster", "Server"]

_log = logging.getLogger("palpate.recording")
OFTEN = BackOff(first_s=0.25, longest_s=10.0)


class Server(Receiver, Protocol):
    """What takes recordings and explorations: `palpate.Client`."""

    def begin_episode(self, episode: StoredEpisode) -> int:
        """Begin an exploration, and tell how many lines of it are there."""

    def put_line(self, episode: UUID, position: int, step: StoredStep) -> int:
        """Add a line, the first one at 1."""


@dataclass(frozen=True)
class Left:
    """Lines that the server does not have, and why."""

    lines: int
    reason: str


class Poster:
    """Sends an exploration line by line, and before each line the recordings that belong to it.

    Each line is in the spool's folder ``episodes`` before it is sent; `palpate.recording.outbox` tells how it is sent
    later.

    Parameters
    ----------
    spool
        Where recordings wait, and lines too.
    server
        Where all of it goes.
    episode
        The exploration as it begins.
    """

    def __init__(self, spool: Spool, server: Server, episode: StoredEpisode, *, back_off: BackOff = OFTEN) -> None:
        self.error: Exception | None = None
        self._spool = spool
        self._server = once(server)
        self._id = episode.id
        self._back_off = back_off
        self._outgoing = Outbox(spool).begin(episode)
        self._jobs: SimpleQueue[Callable[[], object] | None] = SimpleQueue()
        self._added = self._sent = 0
        self._begun = False
        self._answered = threading.Event()
        self._stopped = threading.Event()
        self._jobs.put(lambda: self._begin(episode))
        self._thread = threading.Thread(target=self._run, name="palpate-post", daemon=True)
        self._thread.start()

    def add(self, step: StoredStep, recordings: Sequence[str] = ()) -> None:
        """Keep a line, and let it be sent after the recordings of these names in the spool; it never waits for that.

        Raises
        ------
        RecordingError
            If the line cannot be kept.
        """
        self._outgoing.add(step)
        self._added += 1
        position, names = self._added, tuple(recordings)
        self._jobs.put(lambda: self._put(position, step, names))

    def begun(self, patience_s: float) -> Left | None:
        """Wait a little until the server has taken the exploration or refused it; None where it has taken it."""
        self._answered.wait(patience_s)
        return None if self._begun else self._left(patience_s)

    def close(self, patience_s: float) -> Left | None:
        """Wait a little until all is sent; what is left then, or None."""
        self._jobs.put(None)
        self._thread.join(patience_s)
        self._stopped.set()
        is_sent = self._begun and self._added == self._sent
        self._outgoing.leave(is_sent=is_sent)
        return None if is_sent else self._left(patience_s)

    def _left(self, patience_s: float) -> Left:
        reason = str(self.error or f"there was no answer within {patience_s:g} s")
        return Left(self._added - self._sent, reason)

    def _run(self) -> None:
        while (job := self._jobs.get()) is not None:
            if not self._done(job):
                return

    def _done(self, job: Callable[[], object]) -> bool:
        """Do one thing, as often as it takes; False where it is in vain."""
        failures = 0
        while not self._stopped.is_set():
            try:
                job()
            except (UnreachableError, UnavailableError, OSError) as error:
                self.error, failures = error, failures + 1
                _log.info("not sent yet: %s", error)
                self._stopped.wait(self._back_off.wait_s(failures, asked_s(error)))
            except (ReceiverError, StoreError) as error:
                # the same again would be refused again
                self.error = error
                _log.warning("no more is sent: %s", error)
                self._answered.set()
                return False
            else:
                self.error = None
                return True
        return False

    def _begin(self, episode: StoredEpisode) -> None:
        self._server.begin_episode(episode)
        self._begun = True
        self._answered.set()

    def _put(self, position: int, step: StoredStep, recordings: Sequence[str]) -> None:
        for name in recordings:
            sent = attempt(self._spool, name, self._server)
            if sent is not None and sent.state == "waiting":
                raise UnavailableError(f"{name}: {sent.reason}")
        self._server.put_line(self._id, position, step)
        self._sent = position
