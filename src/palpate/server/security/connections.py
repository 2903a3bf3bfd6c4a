"""Connections that are held open for nothing: very many of them, by slow headers, or by not reading what was asked."""

from __future__ import annotations

import asyncio
import socket
from collections.abc import Iterable
from functools import partial
from typing import Any

from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware
from uvicorn.protocols.http.h11_impl import H11Protocol

from palpate.server.security.addresses import network_at
from palpate.server.security.askers import has_place

__all__ = ["HELD_S", "MOST_OPEN", "MOST_OPEN_OF_A_NETWORK", "MindedConnection"]

HELD_S = 20.0
"""Headers that take longer are let go."""
IDLE_LOOKS = 3
"""Readers that take nothing for so many times as long; the system takes some of an answer before they do."""
UNSENT_BYTES = 64 << 10
"""Of an answer that the system holds before they go; some systems cannot be told."""
MOST_OPEN = 700
"""Connections: fewer than the 1024 files that many systems let a program open, as a database and uploads need some."""
MOST_OPEN_OF_A_NETWORK = 200


class MindedConnection(H11Protocol):
    """A connection that ends when nothing became of it between looks, or when others need its place meanwhile.

    Bodies that come slowly are for `palpate.server.security.bodies`, which tells the sender; and a connection that
    waits for its next request is for the server's own time of keeping it. How many requests are answered at once is
    for `palpate.server.security.places`: as these are fewer than connections, one without a place can be found.
    """

    held_s = HELD_S
    most_open = MOST_OPEN
    most_of_a_network = MOST_OPEN_OF_A_NETWORK

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begin to look."""
        super().connection_made(transport)
        _keep_little_unsent(transport)
        # what is asked on it may be let go, in any thread
        self.app_state = {**self.app_state, "end": partial(self.loop.call_soon_threadsafe, self.end)}
        self._seen: Any = None
        self._unread = self._idle = 0
        self._is_ended = False
        self._waits_since_s = self.loop.time()
        # None where it may be anybody's
        self._network = None if self._is_of_proxy() else network_at(self._host())
        self._look = self.loop.call_later(self.held_s, self._mind)
        self._make_room()

    def connection_lost(self, exc: Exception | None) -> None:
        """Look no more."""
        self._look.cancel()
        super().connection_lost(exc)

    def on_response_complete(self) -> None:
        """Wait for the next request."""
        self._waits_since_s = self.loop.time()
        super().on_response_complete()

    def _host(self) -> str:
        return self.client[0] if self.client else ""

    def _is_of_proxy(self) -> bool:
        """Whether it is from where requests of others are passed on."""
        app = self.config.loaded_app
        return isinstance(app, ProxyHeadersMiddleware) and self._host() in app.trusted_hosts

    def _make_room(self) -> None:
        there = [one for one in self.connections if isinstance(one, MindedConnection) and not one._is_ended]
        own = [one for one in there if one._network == self._network]
        if self._network is not None and len(own) > self.most_of_a_network:
            _end_longest_waiting(own)
        elif len(there) > self.most_open:
            _end_longest_waiting(there)

    @property
    def waits(self) -> bool:
        """Whether no request is under way."""
        return self.cycle is None or self.cycle.response_complete

    @property
    def may_go(self) -> bool:
        """Whether it has no place: refusals, and what needs none, may wait to be read for ever too."""
        return self.waits or not has_place(self.cycle.scope["state"])

    def end(self) -> None:
        """End it now: closing would wait until the answer is read."""
        self._is_ended = True
        self.transport.abort()

    def _mind(self) -> None:
        unread = self.transport.get_write_buffer_size()
        self._idle = self._idle + 1 if unread and unread == self._unread else 0
        if self._idle == IDLE_LOOKS:
            self.end()
            return
        if self.waits and not unread and self.cycle is self._seen:
            self.transport.close()
            return
        self._seen, self._unread = self.cycle, unread
        self._look = self.loop.call_later(self.held_s, self._mind)


def _keep_little_unsent(transport: asyncio.Transport) -> None:
    """Let the system take next to nothing ahead of the line: else it takes megabytes at once, and then none for long.

    Whoever reads steadily would look as if he read nothing meanwhile.
    """
    found: socket.socket | None = transport.get_extra_info("socket")
    if found is not None and found.family in (socket.AF_INET, socket.AF_INET6) and hasattr(socket, "TCP_NOTSENT_LOWAT"):
        found.setsockopt(socket.IPPROTO_TCP, socket.TCP_NOTSENT_LOWAT, UNSENT_BYTES)


def _end_longest_waiting(connections: Iterable[MindedConnection]) -> None:
    """The one that has just come waits too, so that there is one."""
    min((one for one in connections if one.may_go), key=lambda one: one._waits_since_s).end()
