"""Sending recordings to a store elsewhere, over HTTP.

A recording is sent by ``PUT <server>/recordings/<digest>`` with its package (`palpate.store.importing.package`) as the
body and the token as ``Authorization: Bearer <token>``. The answer, 200 where the server has had it already and
201 where it is new, is JSON: ``{"id": ..., "digest": ..., "new": ...}``. A refusal is a problem (RFC 9457) whose
``detail`` is one sentence.
"""

from __future__ import annotations

import http.client
import json
import os
from tempfile import SpooledTemporaryFile
from typing import IO, Protocol
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import HTTPRedirectHandler, Request, build_opener
from uuid import UUID

from palpate.errors import PalpateError
from palpate.store.importing.package import pack
from palpate.store.records import Receipt, Recording

__all__ = [
    "HttpReceiver",
    "NotAllowedError",
    "Receiver",
    "ReceiverError",
    "RefusedError",
    "UnreachableError",
]

IN_MEMORY = 8 << 20
REFUSALS = (400, 409, 413, 415, 422)
ANSWER_BYTES = 64 << 10


class ReceiverError(PalpateError):
    """A recording that has not been received."""


class UnreachableError(ReceiverError):
    """Nobody answered, or not as a store does: the same may go well later."""


class NotAllowedError(ReceiverError):
    """The token is missing or wrong, or may not do this."""


class RefusedError(ReceiverError):
    """The store will not have this recording, however often it is sent."""


class Receiver(Protocol):
    """What recordings can be sent to: a store, or a server that has one."""

    def put(self, recording: Recording) -> Receipt:
        """Keep a recording; when this returns it is kept. The same again is no second one."""


class HttpReceiver:
    """A store behind a server.

    Parameters
    ----------
    url
        Address of the service, such as ``https://measurements.example.org/api/v1``.
    token
        Says who is sending; the environment variable ``PALPATE_TOKEN`` unless given. It goes to no other address.
    timeout_s
        How long to wait for an answer.

    Raises
    ------
    ReceiverError
        If the address is none of a server.
    """

    def __init__(self, url: str, token: str | None = None, *, timeout_s: float = 60.0) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ReceiverError(f"{url!r} is no address of a server, expected https://... or http://...")
        self.url = url.rstrip("/")
        self.timeout_s = timeout_s
        self._token = os.environ.get("PALPATE_TOKEN", "") if token is None else token

    def put(self, recording: Recording) -> Receipt:
        """Send a recording and wait for the server's answer.

        Raises
        ------
        UnreachableError
            If there is no answer, or none that acknowledges this recording.
        NotAllowedError
            If the server does not know the token, or it may not do this.
        RefusedError
            If the server will not have the recording.
        """
        with SpooledTemporaryFile(max_size=IN_MEMORY) as package:
            pack(recording, package)
            size = package.tell()
            package.seek(0)
            answer = self._send(f"{self.url}/recordings/{recording.digest}", package, size)
        receipt = _receipt(self.url, answer)
        if receipt.digest != recording.digest:
            found = f"{self.url}: the answer is about the recording {receipt.digest[:12]}"
            raise UnreachableError(f"{found}, expected {recording.digest[:12]}")
        return receipt

    def _send(self, url: str, package: IO[bytes], size: int) -> bytes:
        headers = {"Content-Type": "application/zip", "Content-Length": str(size), "Accept": "application/json"}
        if self._token:
            headers["Authorization"] = f"Bearer {self._token}"
        request = Request(url, data=package, headers=headers, method="PUT")
        try:
            with build_opener(_NoRedirects).open(request, timeout=self.timeout_s) as answer:
                found: bytes = answer.read(ANSWER_BYTES)
                return found
        except HTTPError as error:
            with error:
                raise self._refusal(error) from None
        except (URLError, http.client.HTTPException, OSError) as error:
            reason = getattr(error, "reason", None) or error
            raise UnreachableError(f"{self.url}: no answer ({reason}), expected a server that has a store") from error

    def _refusal(self, error: HTTPError) -> ReceiverError:
        said = _said(error.read(ANSWER_BYTES))
        if error.code in (401, 403):
            return NotAllowedError(
                f"{self.url}: {said or error.reason}; expected PALPATE_TOKEN to be a token that may send"
            )
        if error.code in REFUSALS:
            return RefusedError(f"{self.url}: refused: {said or error.reason}")
        return UnreachableError(f"{self.url}: answered {error.code} {said or error.reason}, expected 200 or 201")


class _NoRedirects(HTTPRedirectHandler):
    """Follows nothing: the token is for one address."""

    def redirect_request(self, *_: object) -> None:
        """Make the redirection an error."""


def _receipt(where: str, answer: bytes) -> Receipt:
    try:
        plain = json.loads(answer)
        return Receipt(UUID(plain["id"]), str(plain["digest"]), bool(plain["new"]))
    except (AttributeError, KeyError, RecursionError, TypeError, ValueError) as error:
        raise UnreachableError(f"{where}: the answer is no receipt ({error!r}), expected id, digest and new") from error


def _said(answer: bytes) -> str:
    """What the server says about an error; empty where it says nothing that can be read."""
    try:
        plain = json.loads(answer)
    except (RecursionError, ValueError):
        return ""
    said = plain.get("detail") if isinstance(plain, dict) else None
    return said if isinstance(said, str) else ""
