"""Connections that are held open for nothing: by sending headers slowly, or by not reading what was asked for."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

__all__ = ["HELD_S", "MindedConnection"]

HELD_S = 20.0
"""Headers that take longer are let go."""
IDLE_LOOKS = 3
"""Readers that take nothing for so many times as long; the system takes some of an answer before they do."""


class MindedConnection(H11Protocol):
    """A connection that ends when nothing became of it between looks.

    Bodies that come slowly are for `palpate.server.security.bodies`, which tells the sender; and a connection that
    waits for its next request is for the server's own time of keeping it.
    """

    held_s = HELD_S

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to look."""
        super().connection_made(transport)
        self._seen: Any = None
        self._unread = self._idle = 0
        self._look = self.loop.call_later(self.held_s, self._mind)

    def connection_lost(self, exc: Exception | None) -> None:
        """Look no more."""
        self._look.cancel()
        super().connection_lost(exc)

    def _mind(self) -> None:
        unread = self.transport.get_write_buffer_size()
        self._idle = self._idle + 1 if unread and unread == self._unread else 0
        if self._idle == IDLE_LOOKS:
            # closing would wait until it is read
            self.transport.abort()
            return
        asks = self.cycle is None or self.cycle.response_complete
        if asks and not unread and self.cycle is self._seen:
            self.transport.close()
            return
        self._seen, self._unread = self.cycle, unread
        self._look = self.loop.call_later(self.held_s, self._mind)
