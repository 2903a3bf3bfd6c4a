"""A store elsewhere, over HTTP: reading from it and sending recordings to it.

A recording is sent by ``PUT <server>/recordings/<digest>`` with its package (`palpate.store.importing.package`) as the
body and the token as ``Authorization: Bearer <token>``. The answer, 200 where the server has had it already and
201 where it is new, is JSON: ``{"id": ..., "digest": ..., "new": ...}``. A refusal is a problem (RFC 9457) whose
``detail`` is one sentence.
"""

from palpate.client.back_off import BackOff, Patience
from palpate.client.client import Client
from palpate.client.errors import (
    BusyError,
    NotAllowedError,
    NotThereError,
    ReceiverError,
    RefusedError,
    UnreachableError,
    asked_s,
)
from palpate.client.receiver import HttpReceiver, Receiver, once

__all__ = [
    "BackOff",
    "BusyError",
    "Client",
    "HttpReceiver",
    "NotAllowedError",
    "NotThereError",
    "Patience",
    "Receiver",
    "ReceiverError",
    "RefusedError",
    "UnreachableError",
    "asked_s",
    "once",
]
