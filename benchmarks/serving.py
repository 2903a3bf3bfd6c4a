"""A server in a process of its own, and what is sent to it over a connection that stays open."""

import json
import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from http.client import HTTPConnection, HTTPResponse
from pathlib import Path
from time import perf_counter
from typing import Any, Self

from benchmarks.made_up import recordings
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.store.opening import open_store
from palpate.store.records import Recording
from tests.server.packages import package
from tests.server.serving import served
from tests.store.places import check_services, emptied

API = "/api/v1"
OWNER = "robot"
Package = tuple[str, bytes]


def owned(first: int, count: int) -> list[Recording]:
    """Squeezes that everybody may see, of one owner; the same number is the same recording."""
    return [replace(one, owner=OWNER, visibility="public") for one in recordings(first, count)]


def packages(first: int, count: int) -> list[Package]:
    """Digests and packages, as they are sent."""
    return [(one.digest, package(one)) for one in owned(first, count)]


class Asking:
    """A connection to a server, with a token."""

    def __init__(self, address: str, token: str) -> None:
        self._connection = HTTPConnection(address.removeprefix("http://"), timeout=120)
        self._headers = {"Authorization": f"Bearer {token}"}

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._connection.close()

    def get(self, path: str, *, accept: str = "*/*") -> tuple[int, bytes]:
        """Status and body."""
        return self._ask("GET", path, None, {"Accept": accept})

    def put(self, sent: Package) -> tuple[int, bytes]:
        """Upload a recording."""
        digest, data = sent
        return self._ask("PUT", f"{API}/recordings/{digest}", data, {"Content-Type": "application/zip"})

    def post(self, data: bytes, kind: str) -> tuple[int, bytes]:
        """Upload a batch."""
        return self._ask("POST", f"{API}/recordings", data, {"Content-Type": kind})

    def _ask(self, method: str, path: str, body: bytes | None, headers: dict[str, str]) -> tuple[int, bytes]:
        self._connection.request(method, path, body, {**self._headers, **headers})
        answer: HTTPResponse = self._connection.getresponse()
        return answer.status, answer.read()


@contextmanager
def serving(kind: str, folder: Path, *options: str) -> Iterator[tuple[str, str, Any]]:
    """Serve a durable store of a kind; its address, a token, and the process."""
    check_services(kind)
    place = emptied() if kind == "postgresql" else str(folder / "store.sqlite")
    os.environ["PALPATE_BLOBS"] = str(folder / "blobs")
    with open_store(place) as store:
        add_user(store, OWNER, Role.OWNER)
        token = issue(store, OWNER)
    with served(place, "--rate", "1000000", *options) as (address, process):
        yield address, token, process
        # with the processes that it has started
        process.terminate()
        process.wait(60)


def upload(address: str, token: str, sent: Sequence[Package], clients: int) -> float:
    """Seconds in which clients upload all, each its part, one after the other."""

    def work(number: int) -> None:
        with Asking(address, token) as asking:
            for one in sent[number::clients]:
                status, said = asking.put(one)
                assert status == 201, said

    start = perf_counter()
    with ThreadPoolExecutor(clients) as threads:
        list(threads.map(work, range(clients)))
    return perf_counter() - start


def kept(said: bytes, status: int = 201) -> int:
    """How many of a batch were kept; all must have been."""
    items = json.loads(said)["items"]
    assert all(item["status"] == status for item in items), said[:500]
    return len(items)


def memory_mb(process: int) -> float:
    """What a process, and all that it has started, have in memory [MB], of the largest of them."""
    children = Path(f"/proc/{process}/task/{process}/children").read_text().split()
    lines = Path(f"/proc/{process}/status").read_text().splitlines()
    own = next(int(line.split()[1]) / 1024 for line in lines if line.startswith("VmRSS"))
    return max([own, *(memory_mb(int(child)) for child in children)])
