"""A server on this computer: uploads with a token, batches, lists, pages, how soon it is there, and its memory.

`palpate serve` runs in a process of its own, over SQLite with synchronous=FULL or PostgreSQL as it is set up: 201 means
that it is on the disk. The clients run beside it on the same processors. What is compared with is a commit of one row,
and the server's answer to `/health`, which is a question to the database and nothing else.
"""

import json
import uuid
from collections.abc import Iterator
from contextlib import ExitStack
from itertools import count
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import Any

import pytest

from benchmarks.least import BareCommits
from benchmarks.made_up import BATCH
from benchmarks.serving import API, Asking, kept, memory_mb, owned, packages, serving, upload
from palpate.store.importing.lines import line_of
from palpate.store.opening import open_store
from tests.server.packages import package
from tests.store.places import POSTGRESQL

Fixture = Any  # pytest-benchmark's fixture
UPLOADS, ROUNDS, MANY = 200, 5, 100_000
TARGET_S = {"sqlite": 1 / 250, "postgresql": 1 / 100}


@pytest.mark.parametrize("clients", [1, 4])
@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_single_uploads(benchmark: Fixture, tmp_path: Path, kind: str, clients: int) -> None:
    """A squeeze in each request, by one client and by several."""
    who = "one client" if clients == 1 else f"{clients} clients"
    benchmark.extra_info.update(what=f"server, an upload, {kind}, {who}", each=UPLOADS, target_s=TARGET_S[kind])
    with ExitStack() as stack:
        address, token, _ = stack.enter_context(serving(kind, tmp_path))
        numbers = count(0, UPLOADS)
        place = tmp_path / "bare.sqlite" if kind == "sqlite" else str(POSTGRESQL)
        bare, commits = BareCommits(stack, place), list[float]()
        upload(address, token, packages(10**7, 20), clients)

        def setup() -> tuple[tuple[Any, ...], dict[str, Any]]:
            commits.append(bare.seconds(owned(0, 50)))
            return (address, token, packages(next(numbers), UPLOADS), clients), {}

        benchmark.pedantic(upload, setup=setup, rounds=ROUNDS)
        benchmark.extra_info["least_s"] = median(commits)
        with Asking(address, token) as asking:
            for one in owned(UPLOADS * (ROUNDS - 1), 3):
                assert asking.get(f"{API}/recordings/{one.digest}")[0] == 200


@pytest.mark.parametrize("form", ["lines", "packages"])
@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_batches(benchmark: Fixture, tmp_path: Path, kind: str, form: str) -> None:
    """A thousand recordings in a request."""
    benchmark.extra_info.update(what=f"server, one of a batch of {form}, {kind}", each=BATCH, target_s=1 / 3000)
    with serving(kind, tmp_path) as (address, token, _):
        numbers = count(0, BATCH)

        def setup() -> tuple[tuple[Any, ...], dict[str, Any]]:
            made = owned(next(numbers), BATCH)
            if form == "lines":
                return ("\n".join(map(line_of, made)).encode(), "application/x-ndjson"), {}
            edge = uuid.uuid4().hex
            head = 'Content-Disposition: form-data; name="package"; filename="one.zip"'
            parts = [f"--{edge}\r\n{head}\r\n\r\n".encode() + package(one) + b"\r\n" for one in made]
            return (b"".join([*parts, f"--{edge}--\r\n".encode()]), f"multipart/form-data; boundary={edge}"), {}

        def post(data: bytes, kind: str) -> None:
            # one that stays open is closed by the server while the next batch is made
            with Asking(address, token) as asking:
                status, said = asking.post(data, kind)
            assert (status, kept(said)) == (200, BATCH)

        benchmark.pedantic(post, setup=setup, rounds=ROUNDS)


@pytest.fixture(scope="module")
def large(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str, Any]]:
    """A server of 100,000 recordings."""
    folder = tmp_path_factory.mktemp("large")
    with open_store(folder / "store.sqlite", folder / "blobs", durable=False) as store:
        for first in range(0, MANY, BATCH):
            store.put_many(owned(first, BATCH))
    with serving("sqlite", folder) as found:
        yield found


PATHS = {
    "list of 50": (f"{API}/recordings?limit=50", 10e-3),
    "list of 50 by gripper, property": (f"{API}/recordings?limit=50&gripper=gripper3&property=mass", 35e-3),
    "list of 50 by gripper, object": (f"{API}/recordings?limit=50&gripper=gripper3&object=object13", 35e-3),
    "list of 50 by text": (f"{API}/recordings?limit=50&text=object13", 35e-3),
    "first page": ("/", 100e-3),
    "page of all objects": ("/objects", 100e-3),
    "page of an object": ("/objects/made%20up/object13", 100e-3),
    "page of a recording with plots": ("/recordings/{digest}", 150e-3),
}


@pytest.mark.parametrize("what", PATHS)
def test_questions(benchmark: Fixture, large: tuple[str, str, Any], what: str) -> None:
    """What programs and people ask for, of 100,000 recordings."""
    (address, token, _), (path, target_s) = large, PATHS[what]
    path = path.format(digest=owned(0, 1)[0].digest)
    with Asking(address, token) as asking:
        assert asking.get(path, accept="text/html")[0] == 200
        taken = []
        for _ in range(50):
            start = perf_counter()
            asking.get("/health")
            taken.append(perf_counter() - start)
        benchmark.extra_info.update(what=f"server, {what} of {MANY:,}", target_s=target_s, least_s=median(taken))
        found = benchmark.pedantic(lambda: asking.get(path, accept="text/html"), rounds=30, warmup_rounds=3)
    check(path, *found)


def check(path: str, status: int, body: bytes) -> None:
    """An answer must be of what was asked for: 50 recordings that fit, or a page that names the object."""
    assert status == 200
    if not path.startswith(API):
        assert (b"object13" if path.startswith("/objects") else b"object0") in body
        return
    items = json.loads(body)["items"]
    assert len(items) == 50
    if "gripper=" in path:
        assert {item["gripper"] for item in items} == {"gripper3"}
    if "object13" in path:
        assert {item["object"]["name"] for item in items} == {"object13"}
    if "property=" in path:
        assert {entry["property"] for item in items for entry in item["entries"]} == {"mass"}


def test_memory(benchmark: Fixture, large: tuple[str, str, Any]) -> None:
    """What a worker has in memory after 8 clients have uploaded and asked for all of the above."""
    address, token, process = large
    with Asking(address, token) as asking:
        for path, _ in PATHS.values():
            asking.get(path.format(digest=owned(0, 1)[0].digest), accept="text/html")
    benchmark.pedantic(upload, (address, token, packages(2 * 10**7, 400), 8), rounds=1)
    benchmark.extra_info.update(what="server, an upload of 400 by 8 clients", each=400)
    benchmark.extra_info.update(peak_mb=memory_mb(process.pid), target_mb=300)


def test_start(benchmark: Fixture, tmp_path: Path) -> None:
    """From the command to the first answer."""
    benchmark.extra_info.update(what="server, start-up to the first answer", target_s=2.0)

    with ExitStack() as stack:
        numbers = count()

        def start() -> None:
            folder = tmp_path / str(next(numbers))
            folder.mkdir()
            # it is stopped when all have been timed
            stack.enter_context(serving("sqlite", folder))

        benchmark.pedantic(start, rounds=ROUNDS)
