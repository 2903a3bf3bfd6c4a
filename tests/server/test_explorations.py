"""Explorations that others send: line by line, in order, each once, by those who may, and only what a page can show."""

import json
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from dataclasses import replace
from functools import cache
from typing import Any
from uuid import uuid4

import numpy as np
import pytest
from fastapi.testclient import TestClient

import palpate
from palpate.episode.format import About, header_record, step_record
from palpate.robots.sampled import SampledRobot
from palpate.server import explorations
from palpate.server.security.accounts import Role
from palpate.store import keeping_episodes
from palpate.store.describing import change_thing
from palpate.store.entries import Value
from palpate.store.episodes import StoredEpisode
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.records import ThingRef
from palpate.store.store import Store
from tests.store.made_up import START, squeeze

API = "/api/v1/episodes"
Headers = dict[str, str]
Token = Callable[..., Headers]


@cache
def explored() -> StoredEpisode:
    """An exploration that a robot has done, with a line that says why it stopped."""
    network = palpate.load_network("pantry")
    belief = palpate.ExactBelief(network)
    robot = SampledRobot(network, next(iter(network.objects)), np.random.default_rng(3))
    about = About(objective="everything", policy="greedy", stopping="steps:2", robot="sampled")
    episode = StoredEpisode(START, ThingRef("lab", "jar"), header_record(belief, about), owner="ann")
    for step in palpate.explore(belief, robot, stopping=palpate.StepBudget(2)):
        episode = episode.continued(step_record(step))
    return episode


@pytest.fixture
def episode() -> StoredEpisode:
    return replace(explored(), id=uuid4())


def start_of(episode: StoredEpisode, **changes: Any) -> dict[str, Any]:
    thing = {"dataset": episode.thing.dataset, "id": episode.thing.id}
    told = {"started_at": episode.started_at.isoformat(), "thing": thing, "header": dict(episode.header)}
    return {**told, "owner": episode.owner, "visibility": episode.visibility, **changes}


def line_of(episode: StoredEpisode, position: int, **changes: Any) -> dict[str, Any]:
    return {"record": {**episode.steps[position - 1].record, **changes}}


def test_lines_come_one_after_the_other(client: TestClient, store: Store, token: Token, episode: StoredEpisode) -> None:
    """What is kept is what was sent, by its digest; each answer tells how far it is, and each page shows it."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    begun = client.put(address, json=start_of(episode), headers=headers)
    assert (begun.status_code, begun.json().get("lines")) == (201, 0), begun.text
    assert "No step was taken yet" in client.get(f"/episodes/{episode.id}", headers=headers).text
    for position in range(1, 4):
        sent = client.put(f"{address}/lines/{position}", json=line_of(episode, position), headers=headers)
        stop = episode.stop if position == 3 else None
        expected = {"id": str(episode.id), "lines": position, "stop": stop, "page": f"/episodes/{episode.id}"}
        assert (sent.status_code, sent.json()) == (201, expected)
        assert client.get(f"/episodes/{episode.id}", headers=headers).status_code == 200
    assert get_episode(store, episode.id).digest == episode.digest


def test_the_same_again_does_no_harm(client: TestClient, store: Store, token: Token, episode: StoredEpisode) -> None:
    """Beginning and lines are known the second time; who was cut off is told where to go on."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    for status in (201, 200):
        assert client.put(address, json=start_of(episode), headers=headers).status_code == status
        for position in (1, 2):
            line = line_of(episode, position)
            again = client.put(f"{address}/lines/{position}", json=line, headers=headers)
            assert (again.status_code, again.json()["lines"]) == (status, position if status == 201 else 2)
    assert client.put(address, json=start_of(episode), headers=headers).json()["lines"] == 2
    assert len(get_episode(store, episode.id).steps) == 2


def test_lines_do_not_change_and_have_no_gaps(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode
) -> None:
    """Another line at a place, a gap, another beginning, and a line after the end are refused; nothing changes."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    assert client.put(f"{address}/lines/1", json=line_of(episode, 1), headers=headers).status_code == 404
    client.put(address, json=start_of(episode), headers=headers)
    gap = client.put(f"{address}/lines/2", json=line_of(episode, 2), headers=headers)
    assert gap.status_code == 409
    assert "expected line 1" in gap.json()["detail"]
    for position in (1, 2, 3):
        assert client.put(f"{address}/lines/{position}", json=line_of(episode, position), headers=headers).is_success
    other = client.put(f"{address}/lines/1", json=line_of(episode, 1, cost_s=9.0), headers=headers)
    assert (other.status_code, "do not change" in other.json()["detail"]) == (409, True)
    begun = client.put(address, json=start_of(episode, thing={"dataset": "lab", "id": "other"}), headers=headers)
    assert (begun.status_code, "of its own" in begun.json()["detail"]) == (409, True)
    after = client.put(f"{address}/lines/4", json=line_of(episode, 1, step=4), headers=headers)
    assert (after.status_code, "exploration stopped" in after.json()["detail"]) == (422, True)
    assert get_episode(store, episode.id).digest == episode.digest


def test_a_line_that_would_make_a_copy_is_refused(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode
) -> None:
    """Where the same exploration is here under another id, nothing is kept, and the answer does not say it was."""
    headers, copy = token("ann"), replace(episode, id=uuid4())
    for one in (episode, copy):
        begun = client.put(f"{API}/{one.id}", json=start_of(one), headers=headers)
        assert begun.status_code == 201
        for position in (1, 2):
            sent = client.put(f"{API}/{one.id}/lines/{position}", json=line_of(one, position), headers=headers)
            assert sent.status_code == 201
        last = client.put(f"{API}/{one.id}/lines/3", json=line_of(one, 3), headers=headers)
        assert last.status_code == (201 if one is episode else 409), last.text
    assert "under another id" in last.json()["detail"]
    assert len(get_episode(store, copy.id).steps) == 2


def test_only_who_has_begun_goes_on(client: TestClient, token: Token, episode: StoredEpisode) -> None:
    """Others are refused where they see it; what names no owner is that of who has sent it."""
    ann, bob, boss = token("ann"), token("bob"), token("boss", Role.ADMIN)
    assert client.put(f"{API}/{episode.id}", json=start_of(episode), headers=bob).status_code == 422
    address, shared = f"{API}/{episode.id}", start_of(episode, owner=None, visibility="lab")
    assert client.put(address, json=shared, headers=ann).status_code == 201
    line = f"{address}/lines/1"
    assert client.put(line, json=line_of(episode, 1), headers=bob).status_code == 403
    assert client.put(line, json=line_of(episode, 1), headers=ann).status_code == 201
    assert client.put(f"{address}/lines/2", json=line_of(episode, 2), headers=boss).status_code == 201
    hidden = f"{API}/{uuid4()}"
    assert client.put(hidden, json=start_of(episode, started_at="2024-06-01T00:00:00Z"), headers=ann).is_success
    assert client.put(f"{hidden}/lines/1", json=line_of(episode, 1), headers=bob).status_code == 404
    assert client.put(hidden, json=start_of(episode), headers=bob).status_code == 422


def test_a_recording_is_there_before_its_line(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode
) -> None:
    """A line names a recording that its sender may see; one that is private to others is as one that is not there."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    client.put(address, json=start_of(episode), headers=headers)
    own, others = squeeze(owner="ann"), squeeze(1, owner="bob")
    store.put(others)
    said = []
    for digest in (own.digest, others.digest):
        line = {**line_of(episode, 1), "recording": digest}
        found = client.put(f"{address}/lines/1", json=line, headers=headers)
        assert found.status_code == 422
        said.append(found.json()["detail"].replace(digest, "it"))
    assert said[0] == said[1]
    store.put(own)
    line = {**line_of(episode, 1), "recording": own.digest}
    assert client.put(f"{address}/lines/1", json=line, headers=headers).status_code == 201
    assert client.get(address, headers=headers).json()["steps"][0]["recording"] == str(own.id)


def nested(depth: int) -> Any:
    found: Any = 1
    for _ in range(depth):
        found = [found]
    return found


STATES = {"probabilities": {"a": 1.0}, "entropy_bits": 0.0}
NUMBER = {"unit": "g", "mean": 1.0, "sd": 1.0, "entropy_bits": 1.0, "quantiles": {"0.05": 0, "0.5": 1, "0.95": 2}}
ODD: dict[str, dict[str, Any]] = {
    "no belief": {"belief": None},
    "a belief that is a list": {"belief": {"mass": []}},
    "no state": {"belief": {"material": {"probabilities": {}, "entropy_bits": 0.0}}},
    "more than certain": {"belief": {"material": {**STATES, "probabilities": {"a": 2.0}}}},
    "a probability in words": {"belief": {"material": {**STATES, "probabilities": {"a": "most"}}}},
    "a curve of two lengths": {"belief": {"mass": {**NUMBER, "x": [1.0, 2.0], "density": [1.0]}}},
    "a curve without quantiles": {"belief": {"mass": {**NUMBER, "quantiles": {}, "x": [1.0], "density": [1.0]}}},
    "gains in words": {"gains_bits": {"weighing": "much"}},
    "another action": {"action": 7},
    "another step": {"step": 2},
    "a cost that is none": {"cost_s": "long"},
    "a number beyond all": {"cost_s": 10**400},
    "nested deep": {"more": nested(99)},
    "nested deeper": {"more": nested(900)},
    "a zero byte": {"more": "\0"},
}


def test_what_a_page_could_not_show_is_refused(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode
) -> None:
    """Each oddity is one sentence, and leaves nothing behind; after it the right line is taken."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    client.put(address, json=start_of(episode), headers=headers)
    for odd, changes in ODD.items():
        found = client.put(f"{address}/lines/1", json=line_of(episode, 1, **changes), headers=headers)
        assert found.status_code in (400, 422), (odd, found.text)
        assert len(found.json()["detail"]) < 600, odd
        assert get_episode(store, episode.id).steps == (), odd
    assert client.put(f"{address}/lines/1", json=line_of(episode, 1), headers=headers).status_code == 201


NO_BEGINNINGS: list[dict[str, Any]] = [
    {"header": {"format": "palpate-episode/1"}},
    {"header": {}},
    {"started_at": "2999-01-01T00:00:00Z"},
    {"started_at": "2024-01-01T00:00:00"},
    {"thing": {"dataset": "", "id": "x"}},
    {"thing": {"dataset": "lab", "id": "x\u202e"}},
    {"visibility": "everybody"},
    {"more": 1},
]


@pytest.mark.parametrize("unit", ["no such unit", "g", "mK"])
def test_the_page_of_an_object_shows_beliefs_in_any_unit(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode, unit: str
) -> None:
    """Whoever sends an exploration says what its beliefs are in; what is known stands beside those it fits."""
    ann, address = token("ann"), f"/api/v1/episodes/{episode.id}"
    assert client.put(address, json=start_of(episode, visibility="public"), headers=ann).status_code == 201
    change_thing(store, episode.thing, lambda thing: thing.knowing(Value("temperature", 300.0, None, "K"), "a scale"))
    record = json.loads(json.dumps(episode.steps[0].record))
    record["belief"]["temperature"]["unit"] = unit
    line = {"record": record, "recording": None}
    assert client.put(f"{address}/lines/1", json=line, headers=ann).status_code == 201
    page = client.get(f"/objects/{episode.thing.dataset}/{episode.thing.id}")
    assert page.status_code == 200
    shown = page.text.partition(f"temperature [{unit}]")[2].partition("</svg>")[0]
    assert shown
    assert ("true: 300000" in shown) == (unit == "mK")
    assert ("true: " in shown) == (unit == "mK")


def test_a_beginning_that_is_none_is_refused(client: TestClient, token: Token, episode: StoredEpisode) -> None:
    """A header that tells nothing, a wrong time, no object: nothing begins."""
    headers = token("ann")
    for changes in NO_BEGINNINGS:
        refused = client.put(f"{API}/{episode.id}", json=start_of(episode, **changes), headers=headers)
        assert refused.status_code == 422, (changes, refused.text)
        assert client.get(f"{API}/{episode.id}", headers=headers).status_code == 404


def test_an_exploration_has_an_end(
    client: TestClient, token: Token, episode: StoredEpisode, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Neither a line nor an exploration may be of any length."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    client.put(address, json=start_of(episode), headers=headers)
    long = client.put(f"{address}/lines/1", json=line_of(episode, 1, more="x" * (1 << 20)), headers=headers)
    assert long.status_code == 413
    assert client.put(f"{address}/lines/1001", json=line_of(episode, 1), headers=headers).status_code == 422
    monkeypatch.setattr(explorations, "MOST_BYTES", 1000)
    full = client.put(f"{address}/lines/1", json=line_of(episode, 1), headers=headers)
    assert (full.status_code, "expected fewer" in full.json()["detail"]) == (422, True)


def test_two_who_send_at_once_make_one_exploration(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode
) -> None:
    """Each line is there once; who was second is told so, by a 200 or a 409."""
    headers, address = token("ann"), f"{API}/{episode.id}"
    client.put(address, json=start_of(episode), headers=headers)

    def send(_: int) -> list[int]:
        lines = [(n, line_of(episode, n)) for n in (1, 2, 3)]
        return [client.put(f"{address}/lines/{n}", json=line, headers=headers).status_code for n, line in lines]

    with ThreadPoolExecutor(3) as pool:
        found = [status for statuses in pool.map(send, range(3)) for status in statuses]
    assert set(found) <= {200, 201, 409}
    assert found.count(201) == 3
    assert get_episode(store, episode.id).digest == episode.digest


def test_a_line_that_comes_while_an_exploration_is_read_is_no_damage(
    client: TestClient, store: Store, token: Token, episode: StoredEpisode, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its digest and its lines are read as of one moment, so that watchers see it before the line or after."""
    headers, address, documents_of = token("ann"), f"{API}/{episode.id}", keeping_episodes.documents_of
    client.put(address, json=start_of(episode), headers=headers)

    def late(*asked: Any) -> list[str]:
        with monkeypatch.context() as undone:
            undone.setattr(keeping_episodes, "documents_of", documents_of)
            put_episode(store, replace(episode, steps=episode.steps[:1]))
        return documents_of(*asked)

    monkeypatch.setattr(keeping_episodes, "documents_of", late)
    assert get_episode(store, episode.id).steps == ()
    monkeypatch.undo()
    assert len(get_episode(store, episode.id).steps) == 1


@pytest.mark.parametrize("names", [("ann", "ann"), ("ann", "bob")])
def test_of_two_who_send_the_same_at_once_one_is_first(
    client: TestClient,
    store: Store,
    token: Token,
    episode: StoredEpisode,
    monkeypatch: pytest.MonkeyPatch,
    names: tuple[str, str],
) -> None:
    """Both have looked before one writes: one beginning and one line are new; a second account gets nothing of it."""
    headers = {name: token(name) for name in set(names)}
    address, waiting, put = f"{API}/{episode.id}", threading.Barrier(2), put_episode

    def together(*args: Any, **options: Any) -> Any:
        with suppress(threading.BrokenBarrierError):
            waiting.wait(1.0)
        return put(*args, **options)

    monkeypatch.setattr(explorations, "put_episode", together)
    second = 200 if names[0] == names[1] else 409
    with ThreadPoolExecutor(2) as pool:
        start = start_of(episode, owner=None)
        begun = pool.map(lambda name: client.put(address, json=start, headers=headers[name]).status_code, names)
        assert sorted(begun) == sorted((201, second))
        if second == 200:
            line = line_of(episode, 1)
            sent = pool.map(lambda _: client.put(f"{address}/lines/1", json=line, headers=headers["ann"]), range(2))
            assert sorted(one.status_code for one in sent) == [200, 201]
