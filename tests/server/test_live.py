"""Watching an exploration: each step comes as soon as the store has it, and nothing to those who may not see it."""

import json
import re
import threading
import time
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from urllib.request import HTTPCookieProcessor, Request, build_opener, urlopen

import pytest
from fastapi.testclient import TestClient
from typer.testing import CliRunner

from palpate import (
    Above,
    ExactBelief,
    Failed,
    FunctionRobot,
    Label,
    NothingLeft,
    Reading,
    StepBudget,
    explore,
    load_network,
)
from palpate.cli.app import app
from palpate.episode.format import About, header_record
from palpate.episode.keeping import stored_record
from palpate.server.pages import live
from palpate.store.episodes import StoredEpisode
from palpate.store.keeping_episodes import put_episode
from palpate.store.opening import open_store
from palpate.store.records import FileItem, ThingRef
from palpate.store.store import Store
from tests.server.serving import served
from tests.store.made_up import made_episode, squeeze


def line(number: int) -> dict[str, Any]:
    return {"step": number, "action": "weighing", "outcome": {"action": "weighing", "value": 0.1}}


def events_of(text: str) -> list[tuple[str, dict[str, Any]]]:
    """Id and data of each event of a stream."""
    found = []
    for block in text.strip().split("\n\n"):
        fields = dict(one.split(": ", 1) for one in block.splitlines())
        if "data" in fields:
            found.append((fields["id"], json.loads(fields["data"])))
    return found


def test_an_exploration_that_is_over_is_told_once(client: TestClient, store: Store) -> None:
    """Its end comes at once; who has had it gets 204, at which a browser does not ask again."""
    episode = made_episode(stop="nothing is left", visibility="public")
    put_episode(store, episode)
    address = f"/episodes/{episode.id}/events"
    found = client.get(address)
    assert found.headers["content-type"].startswith("text/event-stream")
    assert events_of(found.text) == [("1", {"lines": 1, "stop": "nothing is left"})]
    assert client.get(address, headers={"Last-Event-ID": "1"}).status_code == 204
    assert client.get(f"{address}?after=1").status_code == 204
    for odd in ("x", "-1", "9" * 400, "²"):
        assert client.get(address, params={"after": odd}).status_code == 200


def test_steps_come_while_it_runs_and_who_comes_back_catches_up(
    client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Several watchers get each step in order; one that comes later gets how far it is."""
    monkeypatch.setattr(live, "PAUSE_S", 0.01)
    episode = made_episode(visibility="public")
    put_episode(store, episode)
    address = f"/episodes/{episode.id}/events"
    told: list[list[tuple[str, dict[str, Any]]]] = []
    watchers = [
        threading.Thread(target=lambda: told.append(events_of(client.get(f"{address}?after=0").text))) for _ in range(2)
    ]
    for one in watchers:
        one.start()
    grown: StoredEpisode = episode
    for number in (1, 2):
        time.sleep(0.3)
        grown = grown.continued(line(number))
        put_episode(store, grown)
    time.sleep(0.3)
    put_episode(store, grown.continued({"stop": "enough"}))
    for one in watchers:
        one.join()
    for events in told:
        assert [id for id, _ in events] == ["1", "2", "3"]
        assert events[-1][1]["stop"] == "enough"
    late = events_of(client.get(address, headers={"Last-Event-ID": "1"}).text)
    assert late == [("3", {"lines": 3, "stop": "enough"})]


def test_a_stream_ends_by_itself(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that a server can stop, and a browser that is gone is not served for ever."""
    monkeypatch.setattr(live, "LONGEST_S", 0.2)
    monkeypatch.setattr(live, "PAUSE_S", 0.01)
    episode = made_episode(visibility="public")
    put_episode(store, episode)
    began = time.monotonic()
    assert "retry:" in client.get(f"/episodes/{episode.id}/events").text
    assert time.monotonic() - began < 5


def test_what_nobody_told_of_an_exploration_is_left_out(client: TestClient, store: Store) -> None:
    """A program need not tell how it chooses: the page has no gaps in its place."""
    belief = ExactBelief(load_network("pantry"))
    robot = FunctionRobot({"weigh": lambda: Reading(310.0)})
    header, stop = header_record(belief, About()), {"stop": "nothing is left"}
    bare = StoredEpisode(datetime.now(UTC), ThingRef("lab", "jar"), header, visibility="public")
    for step in explore(belief, robot):
        bare = bare.continued(stored_record(step))
    put_episode(store, bare.continued(stop) if bare.stop is None else bare)
    page = client.get(f"/episodes/{bare.id}").text
    assert "<p>With the network pantry.</p>" in page
    assert "What each is expected to tell.</p>" in page
    assert 3 * "<td>\N{EN DASH}</td>" in client.get("/episodes").text

    told = header_record(belief, About(objective="mass", robot="arm 3"))
    put_episode(store, told_one := StoredEpisode(datetime.now(UTC), ThingRef("lab", "jar"), told, visibility="public"))
    assert (
        "<p>To learn mass, with the robot “arm 3” and the network pantry.</p>"
        in client.get(f"/episodes/{told_one.id}").text
    )


def test_others_see_nothing_of_it(client: TestClient, store: Store, token: Callable[..., dict[str, str]]) -> None:
    """A private exploration is watched by its owner, and is not there for others."""
    episode = made_episode(visibility="private", owner="ann", stop="enough")
    put_episode(store, episode)
    address = f"/episodes/{episode.id}/events"
    assert client.get(address).status_code == 404
    assert client.get(address, headers=token("bob")).status_code == 404
    assert client.get(address, headers=token("ann")).status_code == 200


def test_a_server_that_runs_shows_what_is_recorded_beside_it(tmp_path: Path) -> None:
    """An exploration that keeps its episode in the same store needs no server of its own: its owner sees it."""
    place = tmp_path / "store.sqlite"
    with served(place) as (address, process):
        assert process.stdout is not None
        entrance = next(line.split()[-1] for line in process.stdout if "/enter?key=" in line)
        asked = ["explore", "ceramic_mug", "--seed", "5", "--steps", "1", "--record", "--store", str(place)]
        told = CliRunner().invoke(app, asked, env={"PALPATE_SPOOL": str(tmp_path / "spool")}).output
        (episode,) = re.findall(r"kept as episode ([0-9a-f-]{36})", told)
        owner = build_opener(HTTPCookieProcessor())
        owner.open(entrance).close()
        with owner.open(f"{address}/episodes/{episode}") as page:
            assert b"Step 1: which action?" in page.read()


@pytest.fixture
def running(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, Store]]:
    place = tmp_path_factory.mktemp("live") / "store.sqlite"
    with open_store(place) as store, served(place) as (address, _):
        yield address, store


def test_another_process_explores_and_a_stream_tells(running: tuple[str, Store]) -> None:
    """Over a real connection a step is told well within a second or two of being kept."""
    address, store = running
    store.put(squeeze())
    episode = made_episode(visibility="public")
    put_episode(store, episode)
    with urlopen(Request(f"{address}/episodes/{episode.id}/events?after=0"), timeout=10) as stream:
        assert stream.readline().startswith(b"retry")
        put_episode(store, episode.continued(line(1)))
        began = time.monotonic()
        while not (found := stream.readline()).startswith(b"id"):
            pass
        assert found == b"id: 1\n"
        assert time.monotonic() - began < 5


def test_what_actions_returned_reads_well(client: TestClient, store: Store) -> None:
    """A value stands with its spread and unit, a bound with its side, and a failure with its reason."""
    belief = ExactBelief(load_network("household-filled"))
    robot = FunctionRobot(
        {
            "weighing": lambda: Reading(310.0, 2.5),
            "squeezing": lambda: Above(95.0),
            "mat-sound": lambda: Failed("the microphone was off"),
            "cat-vision": lambda: Label("mug"),
        }
    )
    episode = StoredEpisode(
        datetime.now(UTC), ThingRef("lab", "mug"), header_record(belief, About()), visibility="public"
    )
    for step in explore(belief, robot, stopping=NothingLeft()):
        episode = episode.continued(stored_record(step))
    put_episode(store, episode)
    page = client.get(f"/episodes/{episode.id}").text
    for action, words in (
        ("Weighing", "310 ± 2.5 g"),
        ("Squeezing", "above 95.0 kPa"),
        ("Mat-sound", "failed: the microphone was off"),
        ("Cat-vision", "mug"),
    ):
        assert f"{action}</a>: {words}" in page


def test_pictures_come_with_their_step(client: TestClient, store: Store) -> None:
    """What a camera took is on the page of its step and of no other; a page, which is no picture, is not shown."""
    files = (FileItem("scene.png", "image/png", b"\x89PNG"), FileItem("note.html", "text/html", b"<p>"))
    seen = squeeze(1, visibility="public", files=files)
    store.put(seen)
    belief = ExactBelief(load_network("pantry"))
    robot = FunctionRobot({"weigh": lambda: Reading(310.0)})
    episode = StoredEpisode(
        datetime.now(UTC), ThingRef("lab", "jar"), header_record(belief, About()), visibility="public"
    )
    steps = list(explore(belief, robot, repeat=True, stopping=StepBudget(2)))
    for step, digest in zip(steps, (seen.digest, None, None), strict=True):
        episode = episode.continued(stored_record(step), digest)
    put_episode(store, episode)
    picture = f'<img class="seen" src="/api/v1/recordings/{seen.id}/files/0" alt="Weigh: scene.png">'
    assert client.get(f"/episodes/{episode.id}?step=1").text.count('<img class="seen"') == 1
    assert picture in client.get(f"/episodes/{episode.id}?step=1").text
    assert '<img class="seen"' not in client.get(f"/episodes/{episode.id}?step=2").text
