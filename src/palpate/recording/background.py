"""Sending recordings in the background, for as long as a program runs."""

from __future__ import annotations

import logging
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from time import monotonic

from palpate.client import BackOff, NotAllowedError, Receiver, UnreachableError, asked_s
from palpate.recording.spool import Spool
from palpate.recording.uploading import attempt
from palpate.store.errors import UnavailableError

__all__ = ["Uploader", "uploading"]

_log = logging.getLogger("palpate.recording")


@dataclass(frozen=True)
class _Failed:
    """What is wrong with one recording, how often it was tried, and when it is tried again, by the monotonic clock."""

    error: Exception
    count: int
    until: float


class Uploader:
    """Sends what waits in a spool, in a thread of its own; `uploading` starts and stops it.

    Attributes
    ----------
    error
        Why something is not sent at present; None where nothing is wrong.
    """

    def __init__(
        self, spool: Spool, receiver: Receiver, *, every_s: float = 5.0, back_off: BackOff | None = None
    ) -> None:
        self.error: Exception | None = None
        self._spool = spool
        self._receiver = receiver
        self._every_s = every_s
        self._back_off = back_off or BackOff()
        self._failed: dict[str, _Failed] = {}
        self._stopped = threading.Event()
        self._thread = threading.Thread(target=self._run, name="palpate-upload", daemon=True)

    def start(self) -> None:
        """Begin to send."""
        self._thread.start()

    def stop(self) -> None:
        """Send no more once the recording that is on its way has arrived; the rest waits in the spool."""
        self._stopped.set()
        self._thread.join()

    def _run(self) -> None:
        failures = 0
        while not self._stopped.is_set():
            try:
                self.error = self._pass()
                failures = 0
            except NotAllowedError as error:
                # nobody lets it in later who does not now
                self.error = error
                _log.error("nothing is sent: %s", error)
                return
            except UnreachableError as error:
                self.error, failures = error, failures + 1
                _log.warning("not sent yet: %s", error)
            except Exception as error:
                # whatever it is: a thread that ended would send nothing any more, and nobody would see it
                self.error, failures = error, failures + 1
                _log.exception("not sent yet")
            asked = 0.0 if self.error is None else asked_s(self.error)
            self._stopped.wait(self._back_off.wait_s(failures, asked) if failures else self._every_s)

    def _pass(self) -> Exception | None:
        """Try each recording whose time has come, and return the last error that is about one of them."""
        waiting = self._spool.waiting()
        self._failed = {name: failed for name, failed in self._failed.items() if name in waiting}
        # the waits are between passes, where `stop` ends them
        for name in waiting:
            before = self._failed.get(name)
            if self._stopped.is_set():
                break
            if before is not None and monotonic() < before.until:
                continue
            error = self._try(name)
            if error is None:
                self._failed.pop(name, None)
            else:
                self.error = error
                count = 1 if before is None else before.count + 1
                self._failed[name] = _Failed(error, count, monotonic() + self._back_off.wait_s(count))
        return next((failed.error for failed in reversed(self._failed.values())), None)

    def _try(self, name: str) -> Exception | None:
        try:
            sent = attempt(self._spool, name, self._receiver)
        except (NotAllowedError, UnreachableError):
            # no other recording would fare better
            raise
        except Exception as error:
            # whatever is wrong with one recording, the others must not wait for it
            _log.exception("%s: not sent yet", name)
            return error
        if sent is None:
            return None
        _log.info("%s: %s %s", sent.name, sent.state, sent.reason)
        return UnavailableError(f"{name}: {sent.reason}") if sent.state == "waiting" else None


@contextmanager
def uploading(
    spool: Spool, receiver: Receiver, *, every_s: float = 5.0, back_off: BackOff | None = None
) -> Iterator[Uploader]:
    """Send recordings in the background while the block runs.

    What is not sent when it ends waits in the spool, for the next time or for ``palpate spool upload``.

    Raises
    ------
    NotAllowedError
        When the block ends, if the token was wrong.
    """
    uploader = Uploader(spool, receiver, every_s=every_s, back_off=back_off)
    uploader.start()
    try:
        yield uploader
    finally:
        uploader.stop()
    if isinstance(uploader.error, NotAllowedError):
        raise uploader.error
