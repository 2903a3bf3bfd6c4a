"""Sending a recording to a store elsewhere."""

from __future__ import annotations

from copy import copy
from tempfile import SpooledTemporaryFile
from typing import Any, Protocol, Self, TypeVar
from uuid import UUID

from palpate.client.back_off import Patience
from palpate.client.connection import Connection
from palpate.client.errors import NotThereError, RefusedError, UnreachableError
from palpate.store.checks import check
from palpate.store.errors import StoreError
from palpate.store.importing.package import pack
from palpate.store.records import Receipt, Recording

__all__ = ["HttpReceiver", "Receiver", "check_sendable", "once", "receipt_of"]

IN_MEMORY = 8 << 20


class Receiver(Protocol):
    """What recordings can be sent to: a store, or a server that has one."""

    def put(self, recording: Recording) -> Receipt:
        """Keep a recording; when this returns it is kept. The same again is no second one."""


R = TypeVar("R", bound=Receiver)


class HttpReceiver:
    """A store behind a server.

    Parameters
    ----------
    url
        Address of the service, such as ``https://measurements.example.org/api/v1``; that of a server without a path
        stands for the service there.
    token
        Says who is sending; the environment variable ``PALPATE_TOKEN`` unless given. It goes to no other address.
    timeout_s
        How long to wait for an answer.
    patience
        How it goes on with a server that is busy (503, or 429 where it is asked too often): it asks again, after as
        long as ``Retry-After`` says, a few times; whatever it asks or sends may be asked or sent twice.

    Raises
    ------
    ReceiverError
        If the address is none of a server.
    """

    def __init__(
        self, url: str, token: str | None = None, *, timeout_s: float = 60.0, patience: Patience | None = None
    ) -> None:
        self._connection = Connection(url, token, timeout_s, patience)

    @property
    def url(self) -> str:
        """Where it is."""
        return self._connection.url

    def without_waits(self) -> Self:
        """The same, for those who wait themselves: a server that is busy is a `BusyError` at once."""
        found = copy(self)
        found._connection = self._connection.without_waits()
        return found

    def put(self, recording: Recording) -> Receipt:
        """Send a recording and wait for the server's answer.

        Raises
        ------
        UnreachableError
            If there is no answer, or none that acknowledges this recording.
        NotAllowedError
            If the server does not know the token, or it may not do this.
        RefusedError
            If the server will not have the recording, or no store can have it, as a number in it is not finite;
            nothing is sent then.
        """
        check_sendable(recording)
        return self._put_checked(recording)

    def _put_checked(self, recording: Recording) -> Receipt:
        digest = recording.digest
        with SpooledTemporaryFile(max_size=IN_MEMORY) as package:
            pack(recording, package)
            headers = {"Content-Type": "application/zip", "Content-Length": str(package.tell())}
            package.seek(0)
            try:
                answer = self._connection.ask_plain("PUT", f"/recordings/{digest}", package, headers)
            except NotThereError as error:
                # the address is wrong: what waits goes on waiting
                raise UnreachableError(f"{error}; answered 404, expected the address of a service") from None
        return receipt_of(self._connection, answer, digest)


def check_sendable(recording: Recording) -> None:
    """Refuse what no store can have: a part of it cannot be written, and the server would name only the line.

    Raises
    ------
    RefusedError
        Naming the recording and the field.
    """
    try:
        # whether it is in the future is for the server's clock to say
        check(recording, now=recording.recorded_at, is_new=False)
    except StoreError as error:
        raise RefusedError(f"recording {recording.id}: {error}; nothing of it was sent") from None


def once(receiver: R) -> R:
    """The same receiver, which does not wait by itself for a server that is busy: for those who try again."""
    return receiver.without_waits() if isinstance(receiver, HttpReceiver) else receiver


def receipt_of(connection: Connection, answer: Any, digest: str) -> Receipt:
    """The receipt that an answer is, if it is about this recording."""
    try:
        found = Receipt(
            UUID(answer["id"]), str(answer["digest"]), bool(answer["new"]), tuple(map(str, answer.get("notices", ())))
        )
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        raise connection.strange(f"no receipt ({error!r})") from error
    if found.digest != digest:
        raise connection.strange(f"about the recording {found.digest[:12]} and not {digest[:12]}")
    return found
