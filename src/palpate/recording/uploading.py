"""Sending what waits in the spool to a store."""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from palpate.client import BackOff, Receiver, ReceiverError, RefusedError, UnreachableError, asked_s, once
from palpate.recording.spool import Spool
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.records import Receipt, Recording

__all__ = ["Sent", "attempt", "send", "upload"]

_log = logging.getLogger("palpate.recording")


@dataclass(frozen=True)
class Sent:
    """What became of a recording: ``sent``, ``known`` (the store had it), ``refused`` or still ``waiting``; and why."""

    name: str
    state: str
    reason: str = ""


def upload(
    spool: Spool,
    receiver: Receiver,
    *,
    back_off: BackOff | None = None,
    sleep: Callable[[float], object] = time.sleep,
) -> Iterator[Sent]:
    """Send each recording that waits, the oldest first, and tell what became of it.

    A recording leaves the spool only when the receiver has acknowledged its digest. What it refuses is set aside with
    the reason.

    Parameters
    ----------
    sleep
        Waits so many seconds.

    Raises
    ------
    NotAllowedError
        If the token is wrong; all that is not acknowledged waits on.
    UnreachableError
        If the receiver does not answer after all attempts; likewise.
    """
    trying = _Trying(once(receiver), back_off or BackOff(), sleep)
    for name in spool.waiting():
        with spool.claimed(name) as is_mine:
            if is_mine:
                yield _send(spool, name, trying)


def send(spool: Spool, name: str, receiver: Receiver) -> Sent | None:
    """Send one recording that waits, and tell what became of it; None where somebody else is about it.

    It is tried once. What went wrong is in the answer, and the recording waits on.
    """
    try:
        return attempt(spool, name, receiver)
    except (ReceiverError, OSError) as error:
        return Sent(name, "waiting", str(error))


def attempt(spool: Spool, name: str, receiver: Receiver) -> Sent | None:
    """As `send`, but a receiver that does not answer, a wrong token and a disk that fails are errors."""
    with spool.claimed(name) as is_mine:
        return _send(spool, name, _Trying(once(receiver), BackOff(attempts=1), time.sleep)) if is_mine else None


def _send(spool: Spool, name: str, trying: _Trying) -> Sent:
    try:
        recording = spool.read(name)
    except StoreError as error:
        spool.refuse(name, str(error))
        return Sent(name, "refused", str(error))
    try:
        receipt = trying.put(recording)
    except (UnavailableError, DamagedError) as error:
        # this is about the store and not about the recording
        return Sent(name, "waiting", str(error))
    except (RefusedError, StoreError) as error:
        spool.refuse(name, str(error))
        return Sent(name, "refused", str(error))
    if receipt.digest != recording.digest:
        return Sent(name, "waiting", f"the receipt is for {receipt.digest}, expected {recording.digest}")
    spool.remove(name)
    return Sent(name, "sent" if receipt.new else "known")


@dataclass(frozen=True)
class _Trying:
    """A receiver that is asked several times before it counts as unreachable."""

    receiver: Receiver
    back_off: BackOff
    sleep: Callable[[float], object]

    def put(self, recording: Recording) -> Receipt:
        for failures in range(1, self.back_off.attempts):
            try:
                return self.receiver.put(recording)
            except (UnreachableError, UnavailableError) as error:
                # a store that is busy may have time later
                _log.info("trying again: %s", error)
                self.sleep(self.back_off.wait_s(failures, asked_s(error)))
        return self.receiver.put(recording)
