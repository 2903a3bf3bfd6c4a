"""Watchers of a server with several workers: each line reaches all of them, whichever worker it came to."""

import json
import os
import signal
import socket
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from http.client import HTTPConnection, HTTPResponse
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit
from uuid import uuid4

import numpy as np
import pytest

import palpate
from palpate.episode.format import About, header_record, step_record
from palpate.robots.sampled import SampledRobot
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.store.episodes import StoredEpisode
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from tests.server.serving import served
from tests.store.made_up import START

pytestmark = pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="needs /proc, to know the workers")
PATIENCE_S = 20.0


def explored(steps: int) -> StoredEpisode:
    """An exploration that everybody may watch, with a line for each step and one that says why it stopped."""
    network = palpate.load_network("pantry")
    belief = palpate.ExactBelief(network)
    robot = SampledRobot(network, next(iter(network.objects)), np.random.default_rng(3))
    header = header_record(belief, About())
    episode = StoredEpisode(START, ThingRef("lab", "jar"), header, owner="ann", visibility="public")
    for step in palpate.explore(belief, robot, stopping=palpate.StepBudget(steps), repeat=True):
        episode = episode.continued(step_record(step))
    return episode


class Site:
    """A server with two workers, and an exploration that has begun there."""

    def __init__(self, place: Path, address: str, workers: list[int], token: str, closing: ExitStack) -> None:
        self.place, self.netloc, self.workers, self.token = place, urlsplit(address).netloc, workers, token
        self.closing = closing
        # of each test another one, as the store knows a copy
        self.episode = replace(explored(5), thing=ThingRef("lab", f"jar {uuid4()}"))
        with open_store(place) as store:
            put_episode(store, replace(self.episode, steps=()))

    def request(self, method: str, path: str, sent: Any = None, **headers: str) -> HTTPResponse:
        """Ask by a connection of its own."""
        connection = HTTPConnection(self.netloc, timeout=PATIENCE_S)
        self.closing.callback(connection.close)
        connection.request(method, path, None if sent is None else json.dumps(sent), headers)
        return self.closing.enter_context(connection.getresponse())

    def watch(self, last: int) -> HTTPResponse:
        """A stream, by somebody who has had so many lines."""
        found = self.request("GET", f"/episodes/{self.episode.id}/events", **{"Last-Event-ID": str(last)})
        assert found.readline().startswith(b"retry")
        return found

    def send(self, line: int) -> None:
        """Send a line of the exploration."""
        headers = {"Authorization": f"Bearer {self.token}", "Content-Type": "application/json"}
        sent = {"record": self.episode.steps[line - 1].record}
        found = self.request("PUT", f"/api/v1/episodes/{self.episode.id}/lines/{line}", sent, **headers)
        assert (found.status, json.load(found)["lines"]) == (201, line)


def _workers(parent: int) -> list[int]:
    """The processes that answer; another one looks after what they share."""
    children = Path(f"/proc/{parent}/task/{parent}/children").read_text().split()
    return [int(one) for one in children if b"spawn_main" in Path(f"/proc/{one}/cmdline").read_bytes()]


@contextmanager
def without(worker: int) -> Iterator[None]:
    """Stop a worker, so that the other one takes what comes; briefly, as one that is silent for long is replaced."""
    os.kill(worker, signal.SIGSTOP)
    try:
        yield
    finally:
        os.kill(worker, signal.SIGCONT)


def told(stream: HTTPResponse, until: int) -> list[int]:
    """How many lines there are, as each event of a stream says, until there are so many or it ends."""
    found: list[int] = []
    while (not found or found[-1] < until) and (line := stream.readline()):
        if line.startswith(b"id: "):
            found.append(int(line.removeprefix(b"id: ")))
    return found


@pytest.fixture(scope="module")
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Path, str, list[int], str]]:
    """Where the store and the server are, its workers, and a token."""
    place = tmp_path_factory.mktemp("watched") / "store.sqlite"
    with open_store(place) as store:
        add_user(store, "ann", Role.OWNER)
        token = issue(store, "ann")
    with served(place, "--workers", "2") as (address, process):
        yield place, address, _workers(process.pid), token


@pytest.fixture
def site(running: tuple[Path, str, list[int], str]) -> Iterator[Site]:
    with ExitStack() as closing:
        yield Site(*running, closing)


def test_a_line_that_comes_to_one_worker_is_told_by_the_other(site: Site) -> None:
    """Watchers of either hear of lines that came to either; who comes back goes on where they were, and misses none."""
    first, second = site.workers
    with without(second):
        of_first = [site.watch(0) for _ in range(2)]
    with without(first):
        of_second = [site.watch(0) for _ in range(2)]
        site.send(1)
    assert [told(stream, 1) for stream in (*of_first, *of_second)] == [[1]] * 4
    with without(second):
        site.send(2)
    assert [told(stream, 2) for stream in (*of_first, *of_second)] == [[2]] * 4
    for stream in (*of_first, *of_second):
        stream.close()
    site.send(3)
    with without(first):
        back = [site.watch(2), site.watch(3)]
    assert told(back[0], 3) == [3]
    for line in (4, 5, 6):
        site.send(line)
    for stream, had in zip(back, (3, 3), strict=True):
        events = told(stream, 6)
        assert events == sorted(set(events))
        assert (events[-1], min(events) > had) == (6, True)
    assert site.request("GET", f"/episodes/{site.episode.id}/events", **{"Last-Event-ID": "6"}).status == 204
    with open_store(site.place) as store:
        assert get_episode(store, site.episode.id).digest == site.episode.digest


def test_an_explorer_does_not_wait_for_watchers_that_read_nothing(site: Site) -> None:
    """Many ask for the stream and the page, and take no byte of the answer: each line is answered all the same."""
    asked = f"GET /episodes/{site.episode.id}{{}} HTTP/1.1\r\nHost: {site.netloc}\r\n\r\n"
    for place in range(40):
        one = site.closing.enter_context(socket.socket())
        # as little room as there is, so that the server cannot be done with them
        one.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1024)
        host, port = site.netloc.split(":")
        one.connect((host, int(port)))
        one.sendall(asked.format("/events" if place % 2 else "").encode())
    watcher = site.watch(0)
    for line in range(1, 7):
        began = time.monotonic()
        site.send(line)
        assert time.monotonic() - began < PATIENCE_S / 4
    assert told(watcher, 6)[-1] == 6
