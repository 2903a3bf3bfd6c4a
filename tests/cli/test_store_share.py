"""`palpate store share`: who may see what is in a store already."""

from pathlib import Path

import pytest

from palpate.cli import main
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.opening import open_store
from tests.store.made_up import made_episode, squeeze

MADE = squeeze(1)
EXPLORED = made_episode(MADE)


@pytest.fixture
def place(tmp_path: Path) -> str:
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        store.put(MADE)
        put_episode(store, EXPLORED)
    return str(tmp_path / "store.sqlite")


def share(place: str, *arguments: str) -> int:
    try:
        main(["store", "share", *arguments, "--store", place])
    except SystemExit as ended:
        return int(ended.code or 0)
    return 0


def test_a_recording_is_shared_and_not(place: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Each change is told, and taken back in the reverse order."""
    key = str(MADE.id)
    steps = [
        (["--visibility", "public"], f"{key}: public"),
        (["--embargo", "2099-12-31"], f"{key}: public, not before 2099-12-31 00:00 UTC"),
        (["--embargo", "none"], f"{key}: public"),
        (["--undo"], f"{key}: public, not before 2099-12-31 00:00 UTC"),
        (["--undo"], f"{key}: public"),
        (["--undo"], f"{key}: private"),
    ]
    for arguments, told in steps:
        assert share(place, key[:8], *arguments, "--who", "ann") == 0
        assert capsys.readouterr().out.strip() == told
    assert share(place, key, "--undo") == 2
    assert "has no change of who may see it" in capsys.readouterr().err


def test_an_episode_is_shared(place: str) -> None:
    """By its id, and beside its recordings."""
    assert share(place, str(EXPLORED.id), "--episode", "--visibility", "lab") == 0
    with open_store(place) as store:
        assert get_episode(store, EXPLORED.id).visibility == "lab"
        assert store.get(MADE.id).visibility == "private"


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ([], "expected --visibility or --embargo, or else --undo alone"),
        (["--undo", "--visibility", "lab"], "expected --visibility or --embargo, or else --undo alone"),
        (["--embargo", "soon"], "--embargo 'soon': is no date"),
        (["--embargo", "0001-01-01"], "embargoed_until: found the year 1"),
    ],
)
def test_what_is_wrong_is_one_sentence(
    place: str, arguments: list[str], told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """Code 2, and nothing is changed."""
    assert share(place, str(MADE.id), *arguments) == 2
    said = capsys.readouterr().err
    assert told in said
    with open_store(place) as store:
        assert (store.get(MADE.id).visibility, store.get(MADE.id).embargoed_until) == ("private", None)
