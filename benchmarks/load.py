"""Clients that upload and others that browse, all at once: nothing fails, and what was answered 201 is there.

``python -m benchmarks.load --seconds 120 --uploading 8 --browsing 50 --workers 2``; ``--kind postgresql`` needs
PALPATE_TEST_POSTGRESQL. The clients run beside the server on the same processors, each in a thread.
"""

import argparse
import random
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.serving import API, Asking, owned, serving
from palpate.store.opening import open_store
from tests.server.packages import package
from tests.store.places import POSTGRESQL

__all__ = ["Load", "loaded", "missing"]

PAGES = ("/", "/objects", "/recordings", f"{API}/recordings?limit=50", f"{API}/objects", f"{API}/entries?property=mass")
BUSY = 503
PAUSE_S = 1.0
"""Of somebody who browses, between two pages, at most."""


@dataclass
class Load:
    """What came of it: seconds of each answer, how often each status was answered, and what is kept."""

    seconds: dict[str, list[float]] = field(default_factory=lambda: {"upload": [], "page": []})
    statuses: Counter[tuple[str, int]] = field(default_factory=Counter)
    kept: set[str] = field(default_factory=set)

    def p95_ms(self, what: str) -> float:
        """The time in which 95 of 100 were answered [ms]."""
        times = sorted(self.seconds[what])
        return 1e3 * times[int(0.95 * (len(times) - 1))]

    @property
    def errors(self) -> dict[tuple[str, int], int]:
        """Answers that should not be; to be told to come back is none, as the clients do."""
        return {key: n for key, n in self.statuses.items() if key[1] >= 400 and key[1] != BUSY}

    def note(self, what: str, ask: Callable[[], tuple[int, bytes]]) -> tuple[int, bytes]:
        """Time an answer."""
        start = time.perf_counter()
        status, said = ask()
        self.seconds[what].append(time.perf_counter() - start)
        self.statuses[what, status] += 1
        return status, said


def loaded(address: str, token: str, *, uploading: int, browsing: int, seconds: float, seed: int = 1) -> Load:
    """Upload and browse for so long."""
    load, end = Load(), time.monotonic() + seconds

    def upload(number: int) -> None:
        with Asking(address, token) as asking:
            for place in count():
                if time.monotonic() > end:
                    return
                one = owned((number + 1) * 10**6 + place, 1)[0]
                sent = (one.digest, package(one))
                while (status := load.note("upload", partial(asking.put, sent))[0]) == BUSY:
                    time.sleep(0.1)
                if status in (200, 201):
                    load.kept.add(one.digest)

    def browse(number: int) -> None:
        rng = random.Random(seed + number)
        time.sleep(rng.uniform(0, min(PAUSE_S, seconds / 2)))
        with Asking(address, token) as asking:
            while time.monotonic() < end:
                known = list(load.kept)[-1:]
                path = rng.choice([*PAGES, *(f"/recordings/{digest}" for digest in known)])
                load.note("page", partial(asking.get, path, accept="text/html"))
                time.sleep(rng.uniform(0, PAUSE_S))

    with ThreadPoolExecutor(uploading + browsing) as threads:
        tasks = [threads.submit(upload, number) for number in range(uploading)]
        tasks += [threads.submit(browse, number) for number in range(browsing)]
        for task in tasks:
            task.result()
    return load


def missing(place: str | Path, blobs: Path, kept: set[str]) -> set[str]:
    """Which of these recordings are not in a store, or not what was sent; each is read whole and verified."""
    with open_store(place, blobs) as store:
        lost = kept - store.known(kept)
        for digest in kept - lost:
            assert store.get(digest).digest == digest
    return lost


def main() -> None:
    """Load a server, and print what came of it."""
    asked = argparse.ArgumentParser(description=__doc__)
    asked.add_argument("--seconds", type=float, default=120.0)
    asked.add_argument("--uploading", type=int, default=8)
    asked.add_argument("--browsing", type=int, default=50)
    asked.add_argument("--workers", default="1")
    asked.add_argument("--kind", choices=("sqlite", "postgresql"), default="sqlite")
    given = asked.parse_args()
    with TemporaryDirectory() as name:
        folder = Path(name)
        with serving(given.kind, folder, "--workers", given.workers) as (address, token, _):
            load = loaded(address, token, uploading=given.uploading, browsing=given.browsing, seconds=given.seconds)
        place = folder / "store.sqlite" if given.kind == "sqlite" else str(POSTGRESQL)
        lost = missing(place, folder / "blobs", load.kept)
    for what, times in load.seconds.items():
        print(
            f"{what}: {len(times)} answers, {len(times) / given.seconds:.0f}/s, 95 of 100 in {load.p95_ms(what):.0f} ms"
        )
    print(f"told to come back: {sum(n for key, n in load.statuses.items() if key[1] == BUSY)}")
    print(f"errors: {load.errors or 'none'}; kept {len(load.kept)}, lost {len(lost)}")
    raise SystemExit(1 if load.errors or lost else 0)


if __name__ == "__main__":
    main()
