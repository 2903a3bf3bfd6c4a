"""Running a server: here for oneself, or for many with several workers."""

from __future__ import annotations

import os
import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from tempfile import TemporaryDirectory

import uvicorn

from palpate.server.settings import Settings

__all__ = ["Address", "local_key", "serve"]

KEEP_ALIVE_S = 10
GRACE_S = 20
"""How long answers may take that are under way when the server is told to stop."""
MOST_AT_ONCE = 500


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
        return ("127.0.0.1", "localhost", "[::1]") if self.is_local else ()

    @property
    def url(self) -> str:
        """For people."""
        host = f"[{self.host}]" if ":" in self.host else self.host
        return f"http://{host}:{self.port}"


def local_key() -> str:
    """A key for whoever starts a server."""
    return secrets.token_urlsafe(24)


def serve(settings: Settings, address: Address, *, workers: int = 1) -> None:
    """Serve until told to stop; then answer what is under way, and no more."""
    settings.to_environment()
    with _shared_metrics(workers):
        uvicorn.run(
            "palpate.server.app:from_environment",
            factory=True,
            host=address.host,
            port=address.port,
            workers=workers,
            access_log=False,
            log_level="warning",
            server_header=False,
            date_header=True,
            timeout_keep_alive=KEEP_ALIVE_S,
            timeout_graceful_shutdown=GRACE_S,
            limit_concurrency=MOST_AT_ONCE,
            h11_max_incomplete_event_size=32 << 10,
        )


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
