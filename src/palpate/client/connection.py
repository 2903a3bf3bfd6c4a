"""Requests to a server, and what its errors say."""

from __future__ import annotations

import http.client
import json
import logging
import os
import ssl
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from http.client import HTTPResponse
from itertools import count
from typing import IO, Any
from urllib.error import HTTPError, URLError
from urllib.request import Request

from palpate.client.address import SERVICE, service_at
from palpate.client.back_off import Patience, asked_wait_s
from palpate.client.errors import (
    BusyError,
    NotAllowedError,
    NotThereError,
    ReceiverError,
    RefusedError,
    UnreachableError,
)
from palpate.client.opener import opened

__all__ = ["Connection"]

_log = logging.getLogger("palpate.client")
REFUSALS = (400, 409, 413, 415, 422)
MISSING = (404, 410)
BUSY = (429, 503)
ELSEWHERE = (301, 302, 303, 307, 308)
NO_TLS = ("WRONG_VERSION_NUMBER", "RECORD_LAYER_FAILURE")
"""What an answer without TLS is taken for."""
PROXY_REFUSES = 413
"""Told by proxies too, in their own words: what is too large for them."""
ERROR_BYTES = 64 << 10
LARGEST_ANSWER_BYTES = 64 << 20


class Connection:
    """The address of a service, or of the server that has it, and the token that is sent to no other address."""

    def __init__(self, url: str, token: str | None, timeout_s: float, patience: Patience | None = None) -> None:
        self.url = service_at(url)
        self.timeout_s = timeout_s
        self._token = os.environ.get("PALPATE_TOKEN", "") if token is None else token
        self._patience = patience or Patience()

    def without_waits(self) -> Connection:
        """The same, which asks once and waits for nobody."""
        once = replace(self._patience, back_off=replace(self._patience.back_off, attempts=1))
        return Connection(self.url, self._token, self.timeout_s, once)

    @contextmanager
    def ask(
        self, method: str, path: str, body: IO[bytes] | bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Iterator[HTTPResponse]:
        """The answer to a request, to be read; whatever is no answer of a server that agrees is an error.

        A server that says that it is busy is asked again: it has done nothing, and doing it twice would do no harm.
        """
        found = {"Accept": "application/json", **(headers or {})}
        if self._token:
            found["Authorization"] = f"Bearer {self._token}"
        try:
            with self._answered(method, path, body, found) as answer:
                yield answer
        except (URLError, http.client.HTTPException, OSError) as error:
            raise self._silence(error) from error

    def _answered(
        self, method: str, path: str, body: IO[bytes] | bytes | None, headers: dict[str, str]
    ) -> HTTPResponse:
        start = 0 if body is None or isinstance(body, bytes) else body.tell()
        for failures in count(1):
            try:
                return self._once(Request(f"{self.url}{path}", data=body, headers=headers, method=method))
            except BusyError as error:
                if not self._patience.goes_on(failures, error.after_s):
                    raise
                _log.info("asking again: %s", error)
            if not (body is None or isinstance(body, bytes)):
                body.seek(start)
        raise AssertionError("it is counted without an end")

    def _once(self, request: Request) -> HTTPResponse:
        try:
            return opened(request, self.timeout_s)
        except HTTPError as error:
            with error:
                raise self._refusal(error) from None

    def ask_plain(
        self, method: str, path: str, body: IO[bytes] | bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Any:
        """The same, where the answer is JSON."""
        with self.ask(method, path, body, headers) as answer:
            data = answer.read(LARGEST_ANSWER_BYTES)
        try:
            return json.loads(data)
        except (RecursionError, ValueError) as error:
            raise UnreachableError(self._other(f"the answer is no receipt and no JSON ({error})")) from error

    def strange(self, found: str) -> UnreachableError:
        """The error of an answer that is none of a store."""
        return UnreachableError(f"{self.url}: the answer is {found}, expected that of a store")

    def _refusal(self, error: HTTPError) -> ReceiverError:
        told = _said(error.read(ERROR_BYTES))
        said = told or error.reason
        if error.code in BUSY:
            after_s = asked_wait_s(error.headers.get("Retry-After"), self._patience.now())
            later = f", and asks to wait {after_s:g} s" if after_s else ""
            return BusyError(f"{self.url}: answered {error.code} {said}{later}; the same may go well later", after_s)
        if error.code in (401, 403):
            return NotAllowedError(f"{self.url}: {said}; expected PALPATE_TOKEN to be a token that may do this")
        if error.code in MISSING and told:
            return NotThereError(f"{self.url}: {said}")
        if error.code in REFUSALS and (told or error.code == PROXY_REFUSES):
            return RefusedError(f"{self.url}: refused: {said}")
        if error.code in ELSEWHERE:
            to = str(error.headers.get("Location", "")).partition(SERVICE)[0]
            return UnreachableError(
                f"{self.url}: answered {error.code} and leads to {to[:200]!r}, where nothing is sent: "
                "expected the address at which the server itself answers"
            )
        return UnreachableError(self._other(f"answered {error.code} {said}"))

    def _other(self, found: str) -> str:
        """What to say of something that is perhaps another kind of site."""
        return f"{self.url}: {found}, expected the address of a palpate server, as https://host/ or http://host:8000/"

    def _silence(self, error: Exception) -> UnreachableError:
        reason = getattr(error, "reason", None) or error
        hint = "a server that has a store"
        if isinstance(reason, ssl.SSLCertVerificationError):
            hint = "a certificate that this computer trusts"
        elif isinstance(reason, ssl.SSLError) and reason.reason in NO_TLS:
            hint = f"{self.url.replace('https://', 'http://', 1)} where the server does without TLS"
        elif isinstance(reason, http.client.RemoteDisconnected) and self.url.startswith("http://"):
            hint = f"a server that has a store; or {self.url.replace('http://', 'https://', 1)} where it is behind TLS"
        return UnreachableError(f"{self.url}: no answer ({reason}), expected {hint}")


def _said(answer: bytes) -> str:
    """What the server says about an error; empty where it says nothing that can be read."""
    try:
        plain = json.loads(answer)
    except (RecursionError, ValueError):
        return ""
    said = plain.get("detail") if isinstance(plain, dict) else None
    return said if isinstance(said, str) else ""
