import json
from pathlib import Path
from typing import Any

import pytest

from palpate.episode import read_episode
from palpate.store.opening import open_store
from palpate.store.records import Recording
from palpate.store.verifying import verify

LOOSE = ("--network", "household-filled", "--stop", "nothing-left")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store and a spool that the commands find by the environment."""
    path = tmp_path / "store.sqlite"
    monkeypatch.setenv("PALPATE_STORE", str(path))
    monkeypatch.setenv("PALPATE_SPOOL", str(tmp_path / "spool"))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    return path


def recordings(place: Path) -> list[Recording]:
    with open_store(place) as store, store.engine.connect() as connection:
        digests = connection.exec_driver_sql("SELECT digest FROM recordings ORDER BY id").scalars().all()
        return [store.get(digest.hex()) for digest in digests]


def listed(run: Any) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads(run("store", "episodes", "--json").out)["episodes"]
    return rows


def test_an_exploration_is_recorded_and_replayed(run: Any, place: Path, tmp_path: Path) -> None:
    """Outcomes, choices and beliefs come again from the store, by the episode and by the object's recordings."""
    first = tmp_path / "first.jsonl"
    done = run("explore", "ceramic_mug", "--seed", 5, "--record", "--log", first, *LOOSE)
    (row,) = listed(run)
    assert (row["thing"], row["dataset"], row["actions"]) == ("ceramic_mug", "simulated", 5)
    assert row["id"] in " ".join(done.out.split())
    expected = read_episode(first)
    for session in (f"store:{row['id']}", f"store:{row['digest']}", "store"):
        again = tmp_path / "again.jsonl"
        replay = ("--robot", "replay", "--session", session, "--log", again)
        assert run("explore", "ceramic_mug", *replay, *LOOSE).code == 0
        found = read_episode(again)
        assert [(s.action, s.surprise) for s in found.steps] == [(s.action, s.surprise) for s in expected.steps]
        assert found.posterior == expected.posterior
    with open_store(place) as store:
        assert list(verify(store)) == []


def test_what_was_not_measured_says_so(run: Any, place: Path) -> None:
    """Drawn and replayed outcomes stand under datasets of their own, with a notice and a setup that tell."""
    run("explore", "ceramic_mug", "--seed", 5, "--record", "--steps", 1)
    run("explore", "banana_ycb", "--robot", "replay", "--record", "--steps", 1)
    drawn, replayed = recordings(place)
    assert (drawn.thing.dataset, drawn.setup.other[0].name) == ("simulated", "sampled robot")
    assert "drawn from the sensor models of the network household-filled, not measured" in drawn.notices
    assert (replayed.thing.dataset, replayed.thing.id, replayed.setup.other[0].name) == (
        "replayed",
        "banana_ycb",
        "replay robot",
    )
    assert any(notice.startswith("replayed from") for notice in replayed.notices)


def test_episodes_are_listed_and_shown(run: Any, place: Path, tmp_path: Path) -> None:
    """The list filters and pages; one episode is shown with its recordings, and gives its log."""
    for seed in range(3):
        run("explore", ("ceramic_mug", "white_tile")[seed % 2], "--seed", seed, "--record", "--steps", 1)
    rows = listed(run)
    assert [row["thing"] for row in rows] == ["ceramic_mug", "white_tile", "ceramic_mug"]
    page = run("store", "episodes", "--limit", 2).out
    cursor = page.split("more: --cursor ")[1].strip()
    assert len(json.loads(run("store", "episodes", "--cursor", cursor, "--json").out)["episodes"]) == 1
    assert len(json.loads(run("store", "episodes", "--object", "white_tile", "--json").out)["episodes"]) == 1
    assert not json.loads(run("store", "episodes", "--until", "2020-01-01", "--json").out)["episodes"]
    key, log = rows[0]["id"], tmp_path / "episode.jsonl"
    shown = run("store", "episode", key, "--log", log).out
    assert "3 recordings of 2 objects and 3 episodes" in " ".join(run("store", "show").out.split())
    plain = json.loads(run("store", "episode", key, "--json").out)
    assert plain["steps"][0]["recording"][:12] in shown
    assert read_episode(log).recorded[0][0] == plain["steps"][0]["record"]["action"]
    assert run("episode", "plot", log, tmp_path / "episode.svg").code == 0
    for wrong in ("mug", "00" * 32):
        assert run("store", "episode", wrong).code == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("ceramic_mug", "--robot", "replay", "--session", "store"), "object 'ceramic_mug': is not in the store"),
        (("--robot", "replay", "--session", "store"), "no OBJECT was found"),
        (("--robot", "replay", "--session", "store:mug"), "'mug': is not the beginning of an id"),
        (("--robot", "replay", "--session", f"store:{'0' * 32}"), "is not in the store"),
        (("ceramic_mug", "--session", "store"), "--session is only for --robot replay"),
        (("ceramic_mug", "--store", "x.sqlite"), "--store and --blobs are for --record, --live and --session store"),
        (("ceramic_mug", "--record", "--store", "mysql://x/y"), "store mysql://x/y: found 'mysql', expected"),
    ],
)
def test_what_cannot_be_replayed_is_refused(run: Any, place: Path, arguments: tuple[str, ...], message: str) -> None:
    """One sentence before anything is done."""
    open_store(place).close()
    assert message in run("explore", *arguments).refused


def test_an_episode_of_another_object_is_refused(run: Any, place: Path) -> None:
    """The object that is named must be the one that was explored."""
    run("explore", "ceramic_mug", "--seed", 5, "--record", "--steps", 1)
    session = f"store:{listed(run)[0]['id']}"
    refused = run("explore", "white_tile", "--robot", "replay", "--session", session).refused
    assert "is of the object 'ceramic_mug', expected one of 'white_tile'" in refused
