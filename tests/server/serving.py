"""The command itself, in a process of its own; and an application in a thread."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from urllib.error import URLError
from urllib.request import urlopen

import uvicorn
from fastapi import FastAPI

from palpate.server.security.connections import MindedConnection


def free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        port: int = found.getsockname()[1]
        return port


@contextmanager
def served(place: Path | str, *options: str) -> Iterator[tuple[str, subprocess.Popen[str]]]:
    """Serve a store, and give the address once it answers."""
    port = free_port()
    command = [sys.executable, "-m", "palpate", "serve", "--store", str(place), "--port", str(port), *options]
    # a group of its own, as workers would outlive the process that started them
    process = subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=dict(os.environ), start_new_session=True
    )
    address = f"http://127.0.0.1:{port}"
    try:
        for _ in range(300):
            try:
                urlopen(f"{address}/health").close()
                break
            except (URLError, ConnectionError):
                assert process.poll() is None, process.communicate()
                time.sleep(0.1)
        yield address, process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@contextmanager
def listening(app: FastAPI) -> Iterator[str]:
    """Serve an application here, for clients that need an address."""
    port = free_port()
    server = uvicorn.Server(uvicorn.Config(app, port=port, http=MindedConnection, log_level="error"))
    thread = threading.Thread(target=server.run)
    thread.start()
    try:
        while not server.started:
            assert thread.is_alive()
            time.sleep(0.01)
        yield f"http://127.0.0.1:{port}"
    finally:
        server.should_exit = True
        thread.join()
