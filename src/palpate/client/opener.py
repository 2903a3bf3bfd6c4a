"""Opening an address: redirections are not followed, and a server that ends a body is listened to."""

from __future__ import annotations

from http.client import HTTPConnection, HTTPResponse, HTTPSConnection
from typing import Any, cast
from urllib.request import HTTPHandler, HTTPRedirectHandler, HTTPSHandler, Request, build_opener

__all__ = ["opened"]


def opened(request: Request, timeout_s: float) -> HTTPResponse:
    """The answer to a request; an error of `urllib` where there is none, or none that agrees."""
    return cast(HTTPResponse, build_opener(_NoRedirects, _Http, _Https).open(request, timeout=timeout_s))


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
