"""`palpate explore --live`: a page here, or a server elsewhere that may be away."""

import re
import socket
import threading
import urllib.request
from collections.abc import Iterator
from http.cookiejar import CookieJar
from pathlib import Path
from typing import Any

import pytest

from palpate.cli import keeping
from palpate.recording.outbox import Outbox
from palpate.recording.spool import Spool
from palpate.server.app import application
from palpate.store.keeping_episodes import get_episode
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from tests.server.serving import listening

EXPLORE = ("explore", "ceramic_mug", "--seed", 5)


@pytest.fixture(autouse=True)
def spool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Spool:
    monkeypatch.setenv("PALPATE_SPOOL", str(tmp_path / "spool"))
    return Spool(tmp_path / "spool")


@pytest.fixture
def hanging() -> Iterator[str]:
    """The address of a server that takes connections and never says a word."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        yield f"http://127.0.0.1:{listening.getsockname()[1]}/api/v1"


def steps_of(out: str) -> str:
    """What is printed of the exploration itself."""
    return out[out.index("Before") :]


def test_a_page_here_shows_it(run: Any, tmp_path: Path) -> None:
    """The address that is printed leads to the episode while it runs, and the store has it then."""
    store, seen, printed = tmp_path / "s.sqlite", list[str](), threading.Event()
    original = keeping.Kept

    def look(address: str) -> None:
        browser = urllib.request.build_opener(urllib.request.HTTPCookieProcessor(CookieJar()))
        seen.append(browser.open(address, timeout=60).read().decode())
        printed.set()

    def told(robot: Any, episode: Any, words: str) -> keeping.Kept:
        # before anything is done: it waits for the server to start, not the other way round
        threading.Thread(target=look, args=(words.rpartition(" ")[2],)).start()
        printed.wait(60)
        return original(robot, episode, words)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(keeping, "Kept", told)
        ran = run(*EXPLORE, "--live", "--store", store)
    assert ran.code == 0, ran.err
    assert re.search(r"^watch it at http://127\.0\.0\.1:\d+/enter\?key=[\w-]+&episode=[0-9a-f-]{36}\s*$", ran.out, re.M)
    assert "No step was taken yet" in seen[0]
    with open_store(store) as opened:
        kept = get_episode(opened, list_episodes(opened).rows[0].id)
    assert kept.stop is not None


def test_a_server_that_hangs_changes_nothing(
    run: Any, hanging: str, tmp_path: Path, spool: Spool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The exploration is the same, what is left is told with the way to send it, and that way sends it."""
    monkeypatch.setattr("palpate.episode.posting.PATIENCE_S", 0.2)
    alone, posted = run(*EXPLORE), run(*EXPLORE, "--live", "--to", hanging)
    assert posted.code == 0
    assert steps_of(posted.out) == steps_of(alone.out)
    assert f"did not get to {hanging}" in posted.err
    assert f"to send it: palpate spool upload --to {hanging}" in posted.err
    (name,) = Outbox(spool).waiting()
    assert f"waiting  exploration {name}" in run("spool", "list").out
    sent = run("spool", "upload", "--to", tmp_path / "s.sqlite")
    assert sent.code == 0, sent.out
    with open_store(tmp_path / "s.sqlite") as opened:
        kept = get_episode(opened, list_episodes(opened).rows[0].id)
        assert all(opened.known([step.recording]) for step in kept.steps if step.recording)
    assert str(kept.id) == name
    assert kept.stop is not None
    assert Outbox(spool).waiting() == spool.waiting() == []


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (("--to", "http://x/api/v1"), "expected --live alone"),
        (("--live", "--record", "--to", "http://x/api/v1"), "--record, which keeps it here, was found"),
        (("--live", "--to", "x:8000"), "'x:8000' is no address of a server, expected https://x:8000 or http://x:8000"),
        (("--live", "--to", "http://x/objects"), "which ends in /api/v1: expected http://x/api/v1"),
        (("--live", "--to", "http://x/api/v1", "--store", "s.sqlite"), "--store and --blobs are for"),
    ],
)
def test_options_that_do_not_go_together(run: Any, spool: Spool, options: tuple[str, ...], said: str) -> None:
    """One sentence, and nothing is done."""
    assert said in run(*EXPLORE, *options).refused
    assert not spool.folder.exists()


def test_a_token_that_does_not_hold_is_told_before_the_first_step(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No page is promised that is not there: one reason, and where the exploration is kept."""
    monkeypatch.setenv("PALPATE_TOKEN", "palpate_wrong")
    with open_store(tmp_path / "s.sqlite") as store, listening(application(store)) as url:
        ran = run(*EXPLORE, "--live", "--to", f"{url}/api/v1")
    assert ran.code == 0, ran.err
    heading = ran.out[: ran.out.index("Before")]
    assert "has not taken it" in heading
    assert "the token is not known" in heading
    assert "watch it at" not in ran.out
    assert "no more is sent" not in ran.err
    assert "to send it: palpate spool upload --to" in ran.err


def test_a_pause_after_each_step(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """As long as it was asked for, once for each action; a negative one is refused."""
    slept = list[float]()
    monkeypatch.setattr("palpate.cli.exploring.time.sleep", slept.append)
    ran = run(*EXPLORE, "--pace", "2.5", "--steps", 2)
    assert ran.code == 0, ran.err
    assert [one for one in slept if one == 2.5] == [2.5, 2.5]
    assert "--pace" in run(*EXPLORE, "--pace", "-1").refused
