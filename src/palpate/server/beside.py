"""A server beside a program, for the person who runs it: it ends with the program, however that ends."""

from __future__ import annotations

import multiprocessing
import signal
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import uvicorn

from palpate.server.running import LOCAL_NAMES, local_key
from palpate.server.settings import Settings

__all__ = ["beside"]

HOST = "127.0.0.1"
SOON_S = 5.0
WAITING = 128
"""Connections that wait until the server has started."""


@contextmanager
def beside(place: str | None, blobs: str | None) -> Iterator[str]:
    """Serve a store to this computer, in a process of its own, while the block runs.

    What it gives is the address by which a browser enters. It holds at once: who asks before the server has started
    waits for it, and the program does not.
    """
    settings = Settings(place, blobs, hosts=LOCAL_NAMES, key=local_key(), requests_per_s=None)
    with socket.create_server((HOST, 0), backlog=WAITING) as listening:
        port = listening.getsockname()[1]
        # a new interpreter: a fork would have the threads and the locks of the program half
        context = multiprocessing.get_context("spawn")
        process = context.Process(target=_serve, args=(settings, listening), name="palpate-serve", daemon=True)
        process.start()
        try:
            yield f"http://{HOST}:{port}/enter?key={settings.key}"
        finally:
            process.terminate()
            process.join(SOON_S)
            if process.is_alive():
                process.kill()
                process.join()


def _serve(settings: Settings, listening: socket.socket) -> None:
    from palpate.server.app import application
    from palpate.store.opening import open_store

    # Ctrl-C in a terminal is for the program, which ends this
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    app = application(open_store(settings.place, settings.blobs), settings)
    server = _Server(uvicorn.Config(app, log_level="error", access_log=False, timeout_graceful_shutdown=int(SOON_S)))
    threading.Thread(target=_end_with_parent, args=(server,), daemon=True).start()
    server.run(sockets=[listening])


def _end_with_parent(server: uvicorn.Server) -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
    server.should_exit = True


class _Server(uvicorn.Server):
    """Leaves Ctrl-C alone, which is for the program."""

    def handle_exit(self, sig: int, frame: object) -> None:
        """Stop, unless it was Ctrl-C."""
        if sig != signal.SIGINT:
            self.should_exit = True
