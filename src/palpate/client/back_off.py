"""How long to wait before something is tried again, by oneself and as a server asks for it."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from dataclasses import dataclass, field
from datetime import UTC, datetime
from email.utils import parsedate_to_datetime

__all__ = ["BackOff", "Patience", "asked_wait_s"]


@dataclass(frozen=True)
class BackOff:
    """How often and after how long to try again; each wait is longer, and shortened by chance to half at most.

    Examples
    --------
    >>> BackOff(first_s=1.0, longest_s=5.0).longest_waits(4)
    [1.0, 2.0, 4.0, 5.0]
    """

    attempts: int = 5
    first_s: float = 0.5
    factor: float = 2.0
    longest_s: float = 300.0

    def longest_waits(self, count: int) -> list[float]:
        """The first waits, not shortened [s]."""
        return [self._longest_wait_s(failures) for failures in range(1, count + 1)]

    def wait_s(self, failures: int, asked_s: float = 0.0) -> float:
        """How long to wait after so many failures; as long as was asked for, but not longer than the longest wait."""
        # among many robots that lost one server at once, chance keeps them from coming back at once
        own_s = self._longest_wait_s(failures) * random.uniform(0.5, 1.0)
        return max(own_s, min(asked_s, self.longest_s))

    def _longest_wait_s(self, failures: int) -> float:
        try:
            return min(self.first_s * self.factor ** (failures - 1), self.longest_s)
        except OverflowError:
            # after days without a server the power is beyond every number
            return self.longest_s


def _now() -> datetime:
    return datetime.now(UTC)


@dataclass(frozen=True)
class Patience:
    """How a client goes on asking a server that says that it is busy.

    Attributes
    ----------
    back_off
        How often it asks in all, and how long it waits at most; a server that asks for a longer wait is left alone.
    sleep
        Waits so many seconds.
    now
        The present, for servers that name the moment from which on they can be asked.
    """

    back_off: BackOff = field(default_factory=lambda: BackOff(attempts=4, longest_s=30.0))
    sleep: Callable[[float], object] = time.sleep
    now: Callable[[], datetime] = _now

    def goes_on(self, failures: int, asked_s: float) -> bool:
        """Wait after so many failures, and tell whether to ask again."""
        if failures >= self.back_off.attempts or asked_s > self.back_off.longest_s:
            return False
        self.sleep(self.back_off.wait_s(failures, asked_s))
        return True


def asked_wait_s(retry_after: str | None, now: datetime) -> float:
    """How long the header ``Retry-After`` asks to wait: so many seconds, or until a date; 0 where it says neither.

    Examples
    --------
    >>> asked_wait_s("5", _now()), asked_wait_s(None, _now()), asked_wait_s("soon", _now())
    (5.0, 0.0, 0.0)
    >>> asked_wait_s("Fri, 31 Dec 1999 23:59:59 GMT", datetime(1999, 12, 31, 23, 59, 50, tzinfo=UTC))
    9.0
    """
    text = (retry_after or "").strip()
    if text.isascii() and text.isdigit():
        # beyond the digits that Python reads at once it is longer than anybody waits
        return float(text) if len(text) < 300 else float("inf")
    try:
        moment = parsedate_to_datetime(text)
    except (ValueError, OverflowError):
        return 0.0
    moment = moment if moment.utcoffset() is not None else moment.replace(tzinfo=UTC)
    return max(0.0, (moment - now).total_seconds())
