"""Servers that say when they answer, and not before."""

from __future__ import annotations

import socket
import sys
from collections.abc import Callable, Sequence

import uvicorn
from uvicorn.config import STARTUP_FAILURE
from uvicorn.supervisors import Multiprocess

__all__ = ["run"]

Tell = Callable[[], object]


def run(config: uvicorn.Config, tell: Tell) -> None:
    """As `uvicorn.run`, with a word once somebody who asks is answered; of several workers the first is enough."""
    try:
        if config.workers > 1:
            _Workers(config, [config.bind_socket()], tell).run()
            return
        config.load_app()
        server = _Server(config, tell)
        server.run()
    except KeyboardInterrupt:
        return
    if not server.started:
        sys.exit(STARTUP_FAILURE)


class _Server(uvicorn.Server):
    def __init__(self, config: uvicorn.Config, tell: Tell) -> None:
        super().__init__(config)
        self._tell = tell

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, and say so."""
        await super().startup(sockets)
        if self.started:
            self._tell()


class _Workers(Multiprocess):
    def __init__(self, config: uvicorn.Config, sockets: list[socket.socket], tell: Tell) -> None:
        super().__init__(config, sockets)
        self._tell: Tell | None = tell

    def keep_subprocess_alive(self) -> None:
        """Look after the workers, and say once that one of them listens."""
        super().keep_subprocess_alive()
        if self._tell is not None and _listen(self.sockets):
            tell, self._tell = self._tell, None
            tell()


def _listen(sockets: Sequence[socket.socket]) -> bool:
    """Whether any does: they are bound here, and a worker that has started listens at them."""
    return any(one.getsockopt(socket.SOL_SOCKET, socket.SO_ACCEPTCONN) for one in sockets)
