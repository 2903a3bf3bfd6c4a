"""What goes wrong between a client and a server."""

from __future__ import annotations

from palpate.errors import PalpateError

__all__ = ["NotAllowedError", "NotThereError", "ReceiverError", "RefusedError", "UnreachableError"]


class ReceiverError(PalpateError):
    """A request that was not answered as it should be: a recording that has not been received, or nothing to give."""


class UnreachableError(ReceiverError):
    """Nobody answered, or not as a store does: the same may go well later."""


class NotAllowedError(ReceiverError):
    """The token is missing or wrong, or may not do this."""


class NotThereError(ReceiverError):
    """The server has none of that name, or none that this token may see."""


class RefusedError(ReceiverError):
    """The store will not have this recording, or this is no question to it, however often it is sent."""
