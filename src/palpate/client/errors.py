"""What goes wrong between a client and a server."""

from __future__ import annotations

from palpate.errors import PalpateError

__all__ = [
    "BusyError",
    "NotAllowedError",
    "NotThereError",
    "ReceiverError",
    "RefusedError",
    "UnreachableError",
    "asked_s",
]


class ReceiverError(PalpateError):
    """A request that was not answered as it should be: a recording that has not been received, or nothing to give."""


class UnreachableError(ReceiverError):
    """Nobody answered, or not as a store does: the same may go well later."""


class BusyError(UnreachableError):
    """The server says that it has no time now, and has done nothing.

    Attributes
    ----------
    after_s
        How long it asks to wait before the same is asked again; 0 where it does not say.
    """

    def __init__(self, told: str, after_s: float) -> None:
        super().__init__(told)
        self.after_s = after_s


class NotAllowedError(ReceiverError):
    """The token is missing or wrong, or may not do this."""


class NotThereError(ReceiverError):
    """The server has none of that name, or none that this token may see."""


class RefusedError(ReceiverError):
    """The store will not have this recording, or this is no question to it, however often it is sent."""


def asked_s(error: Exception) -> float:
    """How long a server has asked to wait; 0 where it has not."""
    return error.after_s if isinstance(error, BusyError) else 0.0
