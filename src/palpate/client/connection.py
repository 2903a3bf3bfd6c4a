"""Requests to a server, and what its errors say."""

from __future__ import annotations

import http.client
import json
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from http.client import HTTPConnection, HTTPResponse, HTTPSConnection
from typing import IO, Any
from urllib.error import HTTPError, URLError
from urllib.parse import urlsplit
from urllib.request import HTTPHandler, HTTPRedirectHandler, HTTPSHandler, Request, build_opener

from palpate.client.errors import NotAllowedError, NotThereError, ReceiverError, RefusedError, UnreachableError

__all__ = ["Connection"]

SERVICE = "/api/v1"
REFUSALS = (400, 409, 413, 415, 422)
MISSING = (404, 410)
ERROR_BYTES = 64 << 10
LARGEST_ANSWER_BYTES = 64 << 20


class Connection:
    """The address of a service, or of the server that has it, and the token that is sent to no other address."""

    def __init__(self, url: str, token: str | None, timeout_s: float) -> None:
        parts = urlsplit(url)
        if parts.scheme not in ("http", "https") or not parts.hostname:
            raise ReceiverError(f"{url!r} is no address of a server, expected https://... or http://...")
        # people know a server by its first page: its service is always at the same place
        self.url = url.rstrip("/") if parts.path.strip("/") else parts._replace(path=SERVICE).geturl()
        self.timeout_s = timeout_s
        self._token = os.environ.get("PALPATE_TOKEN", "") if token is None else token

    @contextmanager
    def ask(
        self, method: str, path: str, body: IO[bytes] | bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Iterator[HTTPResponse]:
        """The answer to a request, to be read; whatever is no answer of a server that agrees is an error."""
        found = {"Accept": "application/json", **(headers or {})}
        if self._token:
            found["Authorization"] = f"Bearer {self._token}"
        request = Request(f"{self.url}{path}", data=body, headers=found, method=method)
        try:
            with build_opener(_NoRedirects, _Http, _Https).open(request, timeout=self.timeout_s) as answer:
                yield answer
        except HTTPError as error:
            with error:
                raise self._refusal(error) from None
        except (URLError, http.client.HTTPException, OSError) as error:
            reason = getattr(error, "reason", None) or error
            raise UnreachableError(f"{self.url}: no answer ({reason}), expected a server that has a store") from error

    def ask_plain(
        self, method: str, path: str, body: IO[bytes] | bytes | None = None, headers: Mapping[str, str] | None = None
    ) -> Any:
        """The same, where the answer is JSON."""
        with self.ask(method, path, body, headers) as answer:
            data = answer.read(LARGEST_ANSWER_BYTES)
        try:
            return json.loads(data)
        except (RecursionError, ValueError) as error:
            raise self.strange(f"no receipt and no JSON ({error})") from error

    def strange(self, found: str) -> UnreachableError:
        """The error of an answer that is none of a store."""
        return UnreachableError(f"{self.url}: the answer is {found}, expected that of a store")

    def _refusal(self, error: HTTPError) -> ReceiverError:
        said = _said(error.read(ERROR_BYTES)) or error.reason
        if error.code in (401, 403):
            return NotAllowedError(f"{self.url}: {said}; expected PALPATE_TOKEN to be a token that may do this")
        if error.code in MISSING:
            return NotThereError(f"{self.url}: {said}")
        if error.code in REFUSALS:
            return RefusedError(f"{self.url}: refused: {said}")
        return UnreachableError(f"{self.url}: answered {error.code} {said}, expected 200 or 201")


class _Listening(HTTPConnection):
    """Listens to a server that has ended a body which it does not take: it may have said why."""

    def endheaders(self, message_body: Any = None, *, encode_chunked: bool = False) -> None:
        """Send the headers and the body, as much of it as is taken."""
        try:
            super().endheaders(message_body, encode_chunked=encode_chunked)
        except (BrokenPipeError, ConnectionResetError):
            if self.sock is None:
                raise
            # where it said nothing, reading its answer is an error


class _ListeningTls(_Listening, HTTPSConnection):
    """The same over TLS."""


class _Http(HTTPHandler):
    def http_open(self, request: Request) -> HTTPResponse:
        return self.do_open(_Listening, request)


class _Https(HTTPSHandler):
    def https_open(self, request: Request) -> HTTPResponse:
        return self.do_open(_ListeningTls, request)


class _NoRedirects(HTTPRedirectHandler):
    """Follows nothing: the token is for one address."""

    def redirect_request(self, *_: object) -> None:
        """Make the redirection an error."""


def _said(answer: bytes) -> str:
    """What the server says about an error; empty where it says nothing that can be read."""
    try:
        plain = json.loads(answer)
    except (RecursionError, ValueError):
        return ""
    said = plain.get("detail") if isinstance(plain, dict) else None
    return said if isinstance(said, str) else ""
