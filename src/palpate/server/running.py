"""Running a server: here for oneself, or for many with several workers."""

from __future__ import annotations

import errno
import os
import re
import secrets
import socket
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from tempfile import TemporaryDirectory
from urllib.parse import SplitResult, urlsplit

import uvicorn

from palpate.errors import PalpateError
from palpate.server.announcing import run
from palpate.server.security.connections import MindedConnection
from palpate.server.security.request_heads import LARGEST_HEADERS_BYTES
from palpate.server.settings import Settings

__all__ = ["Address", "PublicAddress", "local_key", "serve"]

LOCAL_NAMES = ("127.0.0.1", "localhost", "[::1]")
HOST = re.compile(r"[a-z0-9]([a-z0-9.-]*[a-z0-9])?|[0-9a-f:.]+")
KEEP_ALIVE_S = 10
GRACE_S = 20
"""How long answers may take that are under way when the server is told to stop."""
FILES = 8192
"""What a process may have open: connections that come at once are counted only when each of them is there."""


class Address:
    """Where a server listens.

    Parameters
    ----------
    host, port
        Name or number of the computer's own address, and the port.

    Examples
    --------
    >>> Address("127.0.0.1", 8000).is_local, Address("0.0.0.0", 8000).is_local
    (True, False)
    """

    def __init__(self, host: str, port: int) -> None:
        self.host, self.port = host, port

    @property
    def is_local(self) -> bool:
        """Whether nobody on another computer can reach it."""
        return self.host in ("127.0.0.1", "localhost", "::1")

    @property
    def names(self) -> tuple[str, ...]:
        """Names under which it is asked where it is local; none, which is any, where it is not."""
        return LOCAL_NAMES if self.is_local else ()

    @property
    def is_secure(self) -> bool:
        """Whether people reach it over TLS, which this server does not speak itself."""
        return False

    @property
    def url(self) -> str:
        """For people."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}"

    def check_free(self) -> None:
        """Refuse where another program listens, or nobody can; raises `palpate.errors.PalpateError`."""
        try:
            family, kind, protocol, _, found = socket.getaddrinfo(self.host, self.port, type=socket.SOCK_STREAM)[0]
            with socket.socket(family, kind, protocol) as tried:
                # as the server does, which need not wait for connections that have ended
                tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
                tried.bind(found)
        except OSError as error:
            if error.errno == errno.EADDRINUSE:
                told = f"--port: {self.port} is in use by another program, expected a free one such as {self.port + 1}"
                raise PalpateError(told) from None
            raise PalpateError(f"--host, --port: cannot listen at {self.url} ({error.strerror})") from None


@dataclass(frozen=True)
class PublicAddress:
    """Where people reach a server, when a proxy passes their requests on.

    Attributes
    ----------
    url
        ``http`` or ``https``, the name of a computer, and a port where it is not the usual one.

    Examples
    --------
    >>> lab = PublicAddress.of("https://Touch.Example.org/")
    >>> lab.url, lab.names[0], lab.is_secure
    ('https://touch.example.org', 'touch.example.org', True)
    >>> PublicAddress.of("touch.example.org")
    Traceback (most recent call last):
    palpate.errors.PalpateError: --public: found 'touch.example.org', expected an address such as https://touch.example.org
    """

    url: str

    @classmethod
    def of(cls, text: str) -> PublicAddress:
        """Read an address; raises `palpate.errors.PalpateError` where it is none."""
        parts = _parts(text)
        if parts is None or parts.scheme not in ("http", "https"):
            raise PalpateError(f"--public: found {text!r}, expected an address such as https://touch.example.org")
        if parts.path.strip("/") or parts.query or parts.fragment or parts.username is not None:
            raise PalpateError(f"--public: found {text!r}, expected no more than {parts.scheme}://{parts.hostname}")
        return cls(f"{parts.scheme}://{parts.netloc.lower()}")

    @property
    def names(self) -> tuple[str, ...]:
        """Names under which the server is asked: its own, and local ones, by which its health is asked."""
        host = urlsplit(self.url).hostname or ""
        return (f"[{host}]" if ":" in host else host, *LOCAL_NAMES)

    @property
    def is_secure(self) -> bool:
        """Whether people reach it over TLS."""
        return self.url.startswith("https:")


def _parts(text: str) -> SplitResult | None:
    """The parts of an address with the name of a computer; None where it has none, or no port that is one."""
    try:
        parts = urlsplit(text)
        return parts if HOST.fullmatch(parts.hostname or "") and parts.port != 0 else None
    except ValueError:
        return None


def local_key() -> str:
    """A key for whoever starts a server."""
    return secrets.token_urlsafe(24)


def serve(settings: Settings, address: Address, tell: Callable[[], object], *, workers: int = 1) -> None:
    """Serve until told to stop; then answer what is under way, and no more. Who asks after `tell` is answered."""
    with _shared_metrics(workers), TemporaryDirectory(prefix="palpate-previews-") as previews:
        replace(settings, previews=previews).to_environment()
        _allow_files()
        config = uvicorn.Config(
            "palpate.server.app:from_environment",
            factory=True,
            host=address.host,
            port=address.port,
            workers=workers,
            http=MindedConnection,
            access_log=False,
            log_level="warning",
            server_header=False,
            date_header=True,
            timeout_keep_alive=KEEP_ALIVE_S,
            timeout_graceful_shutdown=GRACE_S,
            h11_max_incomplete_event_size=LARGEST_HEADERS_BYTES,
        )
        run(config, tell)


def _allow_files() -> None:
    """Let this process and its workers have as many files open as they need, as far as the system lets them."""
    if sys.platform == "win32":
        return
    import resource

    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = FILES if hard == resource.RLIM_INFINITY else min(FILES, hard)
    if soft != resource.RLIM_INFINITY and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


@contextmanager
def _shared_metrics(workers: int) -> Iterator[None]:
    """A folder in which several workers count together."""
    if workers == 1 or "PROMETHEUS_MULTIPROC_DIR" in os.environ:
        yield
        return
    with TemporaryDirectory(prefix="palpate-metrics-") as folder:
        os.environ["PROMETHEUS_MULTIPROC_DIR"] = folder
        yield
        del os.environ["PROMETHEUS_MULTIPROC_DIR"]
