import json
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import polars as pl
import pytest
import typer
import typer.main

from palpate.cli import store_options as module
from palpate.cli.app import app
from palpate.cli.exporting import ALLOWED, Wishes, tell_written
from palpate.cli.store_options import Which
from palpate.store.archive import Archive
from palpate.store.exporting.hugging_face import HuggingFace
from palpate.store.exporting.lerobot.dataset import LeRobot
from palpate.store.exporting.lerobot.resampling import Linear, Nearest
from palpate.store.exporting.tables import Tables
from palpate.store.exporting.writing import Written
from palpate.store.filters import Filter
from palpate.store.opening import open_store
from palpate.store.reading_archive import read_archive
from tests.store.made_up import squeeze

NOTHING: dict[str, Any] = {
    "title": None,
    "authors": (),
    "licence": None,
    "include_private": False,
    "fps": None,
    "resample": None,
    "assumed_rate_hz": None,
}


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store with four recordings, three of them public, which the commands find by the environment."""
    path = tmp_path / "store.sqlite"
    monkeypatch.setenv("PALPATE_STORE", str(path))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    with open_store(path) as store:
        store.put_many([squeeze(number, visibility="public" if number else "lab") for number in range(4)])
    return path


def test_each_format_is_written(run: Any, place: Path, tmp_path: Path) -> None:
    """Each format makes a folder of its kind, says how many recordings it holds, and what was left out."""
    stated = ("--licence", "CC-BY-4.0", "--author", "Doe, Jane", "--author", "the lab", "--title", "Squeezes")
    left = "- 1 recording left out, not public (--include-private takes them too)\n"
    for form, file in (("parquet", "croissant.json"), ("hugging-face", "README.md"), ("lerobot", "meta/info.json")):
        folder = tmp_path / form
        assert run("store", "export", folder, "--format", form, *stated).out == f"{folder}: 3 recordings\n{left}"
        assert (folder / file).is_file()
        assert "Squeezes" in (folder / "CITATION.cff").read_text(encoding="utf-8")
    folder = tmp_path / "archive"
    assert run("store", "export", folder).out == f"{folder}: 4 recordings\n"
    assert len(list(read_archive(folder))) == 4


def test_filters_are_those_of_list(run: Any, place: Path, tmp_path: Path) -> None:
    """What list shows for some options is what export takes for the same."""
    for number, options in enumerate((["--object", "object0"], ["--property", "elasticity", "--until", "2000-01-01"])):
        shown = json.loads(run("store", "list", *options, "--json").out)["recordings"]
        assert run("store", "export", tmp_path / str(number), *options).code == 0
        assert {str(each.id) for each in read_archive(tmp_path / str(number))} == {row["id"] for row in shown}


def test_private_recordings_come_when_asked_for(run: Any, place: Path, tmp_path: Path) -> None:
    """With --include-private nothing is left out."""
    ran = run(
        "store", "export", tmp_path / "all", "--format=parquet", "--include-private", "--licence=MIT", "--author=x"
    )
    assert ran.out == f"{tmp_path / 'all'}: 4 recordings\n"
    assert len(pl.read_parquet(tmp_path / "all" / "data" / "recordings-*.parquet")) == 4


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (
            ["--format", "parket"],
            "--format: 'parket' was found (did you mean 'parquet'?); choose from 'archive', 'parquet'",
        ),
        (
            ["--format", "parquet"],
            "export: --author: no recording names an owner, expected who made the data; "
            "--licence: found none for 3 recordings, expected one for all",
        ),
        (["--format", "lerobot", "--author", "x"], "--licence: found none for 3 recordings, expected one for all"),
        (
            ["--format", "hugging-face", "--object", "object0", "--until", "2024-05-01T12:00:01"],
            "--include-private: none of the 1 recording that match is public, expected some; --author: no recording "
            "names an owner, expected who made the data; --licence: found none for 1 recording, expected one for all",
        ),
        (
            ["--licence", "MIT"],
            "--licence: is nothing that --format archive has, expected --format parquet or hugging-face",
        ),
        (
            ["--format", "parquet", "--fps", "30"],
            "--fps: is nothing that --format parquet has, expected --format lerobot",
        ),
        (
            ["--format", "lerobot", "--resample", "cubic"],
            "--resample: 'cubic' was found; choose from 'nearest', 'linear'",
        ),
        (["--format", "lerobot", "--assumed-rate", "0"], "--assumed-rate: 0 was found, expected samples per second"),
        (
            ["--format", "lerobot", "--assumed-rate", "nan"],
            "--assumed-rate: nan was found, expected samples per second",
        ),
        (["--format", "lerobot", "--fps", "0"], "Invalid value for '--fps'"),
        (["--format", "parquet", "--text", "dancing"], "export: no recording matches, expected one at least"),
        (["--format", "parquet", "--action", "dancing"], "--action: the store has no action 'dancing'"),
        (["--since", "soon"], "--since: 'soon' was found, expected a date or time"),
    ],
)
def test_bad_options_are_refused(run: Any, place: Path, tmp_path: Path, options: list[str], message: str) -> None:
    """What cannot be is one sentence on standard error with exit code 2, and no folder."""
    before = set(tmp_path.iterdir())
    assert message in run("store", "export", tmp_path / "new", *options).refused
    assert set(tmp_path.iterdir()) == before


def test_all_that_is_lacking_is_told_at_once(run: Any, tmp_path: Path) -> None:
    """The example has neither a licence nor rates, and is private: one sentence names each option."""
    place = ("--store", tmp_path / "example.sqlite")
    run("store", "import", "--example", *place)
    weighing = ("store", "export", tmp_path / "new", "--format", "lerobot", "--action", "weighing", *place)
    refused = run(*weighing).refused
    for option in (
        "--include-private: none of",
        "--author: no",
        "--licence: found none",
        "--assumed-rate: neither a rate",
    ):
        assert option in refused
    assert "joint4_torque of 1 recording, expected samples per second to assume" in refused
    stated = ("--include-private", "--author", "x", "--licence", "MIT", "--assumed-rate", 100)
    assert run(*weighing, *stated).code == 0


def test_an_existing_folder_is_left_alone(run: Any, place: Path, tmp_path: Path) -> None:
    """A folder that is there is not written to."""
    (tmp_path / "there").mkdir()
    ran = run("store", "export", tmp_path / "there", "--format", "lerobot", "--licence", "MIT", "--author", "x")
    assert "exists already, expected the name of a new folder" in ran.refused
    assert not list((tmp_path / "there").iterdir())


def test_an_interrupt_leaves_nothing(place: Path, tmp_path: Path) -> None:
    """Ctrl-C in the middle ends with code 130, and neither the folder nor a draft of it is there."""
    with open_store(place, durable=False) as store:
        store.put_many([squeeze(number, visibility="public") for number in range(4, 2000)])
    target = tmp_path / "exports" / "new"
    target.parent.mkdir()
    command = [sys.executable, "-m", "palpate", "store", "export", str(target), "--format=parquet"]
    with subprocess.Popen([*command, "--licence=MIT", "--author=x"], stderr=subprocess.PIPE, text=True) as process:
        deadline = time.monotonic() + 60
        while not list(target.parent.glob(".new-*/data/*")):
            assert time.monotonic() < deadline
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        _, told = process.communicate(timeout=60)
    assert (process.returncode, told) == (130, "palpate: interrupted\n")
    assert not list(target.parent.iterdir())


def test_options_become_objects() -> None:
    """Each name is a format of its own, and what is not said is the default."""
    assert Wishes("archive", **NOTHING).format() == Archive()
    stated = {**NOTHING, "title": "T", "authors": ("A",), "licence": "MIT", "include_private": True}
    for form, kind in (("parquet", Tables), ("hugging-face", HuggingFace)):
        found = Wishes(form, **stated).format()
        assert isinstance(found, kind)
        assert (found.terms.title, found.terms.authors, found.terms.licence) == ("T", ("A",), "MIT")
        assert found.terms.include_private
    plain = Wishes("lerobot", **NOTHING).format()
    assert isinstance(plain, LeRobot)
    assert (plain.fps, plain.resampling, plain.assumed_rate_hz) == (30, Nearest(), None)
    asked = Wishes("lerobot", **{**NOTHING, "fps": 5, "resample": "linear", "assumed_rate_hz": 2.0}).format()
    assert isinstance(asked, LeRobot)
    assert (asked.fps, asked.resampling, asked.assumed_rate_hz) == (5, Linear(), 2.0)
    assert set(ALLOWED) == {"archive", "parquet", "hugging-face", "lerobot"}


def test_many_notices_are_cut_short(capsys: pytest.CaptureFixture[str]) -> None:
    """Where much was left out the command says how much more there is; the card has it."""
    tell_written(Path("new"), Written(3, tuple(f"notice {number}" for number in range(23)), withheld=2))
    lines = capsys.readouterr().out.splitlines()
    assert lines[:2] == ["new: 3 recordings", "- 2 recordings left out, not public (--include-private takes them too)"]
    assert lines[2:] == [*(f"- notice {number}" for number in range(20)), "- and 3 more"]


def test_commands_that_select_share_their_options() -> None:
    """List and export have all options that select, with the same words, and every condition of a filter is one."""
    store = typer.main.get_command(app).commands["store"].commands  # type: ignore[attr-defined]
    both = [
        {
            part.name: (part.opts, part.help)
            for part in store[name].params
            if getattr(part, "rich_help_panel", "") == module.WHICH
        }
        for name in ("list", "export")
    ]
    assert both[0] == both[1]
    assert len(both[0]) == len(vars(Which()))
    # who may see it is asked in other words
    assert len(vars(Which())) == len(vars(Filter())) - 1
