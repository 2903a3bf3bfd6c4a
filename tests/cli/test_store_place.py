"""Where a store is: only what writes makes one, and what is not installed is named."""

import sqlite3
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import typer
import typer.main

from palpate.cli.app import app
from palpate.recording.spool import Spool
from palpate.store.opening import open_store
from tests.store.made_up import squeeze

MAKES = {"palpate store import", "palpate store object add", "palpate store schema"}


def needing(command: Any, path: str = "palpate store") -> Iterator[tuple[str, list[str]]]:
    """Each command that needs a store, with something for whatever it cannot do without."""
    inner = getattr(command, "commands", {})
    for name, part in inner.items():
        yield from needing(part, f"{path} {name}")
    if not inner and path not in MAKES:
        needed = [part for part in command.params if part.required]
        texts = ([part.opts[0], "ab.npz"] if part.opts[0].startswith("--") else ["ab"] for part in needed)
        yield path, [text for one in texts for text in one]


ALL = dict(needing(typer.main.get_command(app).commands["store"]))  # type: ignore[attr-defined]

ALL["palpate store share"].extend(("--visibility", "public"))


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to be in, without a store that is found by the environment."""
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    monkeypatch.delenv("PALPATE_STORE", raising=False)
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    return tmp_path / "here"


@pytest.mark.parametrize("command", ALL)
def test_what_needs_a_store_makes_none(run: Any, folder: Path, command: str) -> None:
    """A name mistyped is said to be no store, and nothing is made: neither a file nor a folder."""
    for place in ("typo.sqlite", "no/folder/typo.sqlite"):
        refused = run(*command.split()[1:], *ALL[command], "--store", place).refused
        assert f"there is no store at {folder / place}, expected one that" in refused
    assert not list(folder.iterdir())


@pytest.mark.parametrize("what", ["nothing", "other tables"])
def test_a_file_without_a_store_in_it_gets_none(run: Any, folder: Path, what: str) -> None:
    """An empty file and the database of another program are no stores, and get no tables."""
    if what == "nothing":
        Path("other.sqlite").touch()
    else:
        with sqlite3.connect("other.sqlite") as connection:
            connection.execute("CREATE TABLE visits (id)")
        connection.close()
    assert "there is no store at" in run("store", "verify", "--store", "other.sqlite").refused
    connection = sqlite3.connect("other.sqlite")
    assert {name for (name,) in connection.execute("SELECT name FROM sqlite_master")} <= {"visits"}
    connection.close()


def test_the_database_of_another_program_is_left_as_it_is(run: Any, folder: Path) -> None:
    """What writes refuses it, and what reads finds no store in it; not one byte of it is changed."""
    with sqlite3.connect("other.sqlite") as connection:
        connection.execute("CREATE TABLE visits (id)")
    connection.close()
    before = Path("other.sqlite").read_bytes()
    explore = ("explore", "ceramic_mug", "--seed", 1, "--steps", 1, "--record")
    for command in (("store", "import", "--example"), ("store", "object", "add", "our/mug"), explore):
        refused = run(*command, "--store", "other.sqlite").refused
        assert f"store '{folder / 'other.sqlite'}': holds the tables of another program" in refused
    assert "there is no store at" in run("store", "show", "--store", "other.sqlite").refused
    assert Path("other.sqlite").read_bytes() == before
    assert [path.name for path in folder.iterdir()] == ["other.sqlite"]


def test_what_replays_or_fits_makes_none(run: Any, folder: Path) -> None:
    """A replay from a store and a fit to one need one that is there."""
    for command in (
        ("explore", "mug", "--robot", "replay", "--session", "store"),
        ("explore", "mug", "--robot", "replay", "--session", "store:ab"),
        ("network", "fit", "--like", "household", "-o", "own.toml"),
    ):
        assert "there is no store at" in run(*command, "--store", "typo.sqlite").refused
    assert not list(folder.iterdir())


def test_what_writes_makes_one(run: Any, folder: Path) -> None:
    """An import, an object that is added, and an exploration that is kept, make the store and say so."""
    explore = ("explore", "ceramic_mug", "--seed", 1, "--steps", 1, "--record")
    for name, command in (
        ("a", ("store", "import", "--example")),
        ("b", ("store", "object", "add", "our/mug")),
        ("c", explore),
    ):
        ran = run(*command, "--store", f"{name}.sqlite")
        assert ran.code == 0
        assert f"palpate: new store made at {folder / name}.sqlite\n" in ran.err
    assert "new store" not in run(*explore, "--store", "c.sqlite").err
    for name in "abc":
        assert run("store", "verify", "--store", f"{name}.sqlite").out == "all is as it was written\n"


@pytest.mark.parametrize("empty", ["", " "])
def test_a_place_that_is_empty_is_refused(run: Any, folder: Path, monkeypatch: pytest.MonkeyPatch, empty: str) -> None:
    """A variable of the shell that is not set does not send recordings to another store."""
    monkeypatch.setenv("PALPATE_STORE", "other.sqlite")
    explore = ("explore", "ceramic_mug", "--seed", 1, "--steps", 1, "--record")
    for command in (("store", "import", "--example"), ("store", "show"), explore):
        assert f"store: found {empty!r}, expected a place" in run(*command, "--store", empty).refused
        assert f"blobs: found {empty!r}, expected a place" in run(*command, "--blobs", empty).refused
    Spool("spool", sync=False).add(squeeze())
    assert (
        f"store: found {empty!r}, expected a place" in run("spool", "upload", "--spool", "spool", "--to", empty).refused
    )
    assert [path.name for path in folder.iterdir()] == ["spool"]


@pytest.mark.parametrize("place", ["postgresql+psycopg://ann:secret@host/lab", "postgresql://ann:secret@host/lab"])
def test_the_driver_of_postgresql_is_named(run: Any, monkeypatch: pytest.MonkeyPatch, place: str) -> None:
    """Without psycopg one is told what to install, and a password is not told."""
    monkeypatch.setitem(sys.modules, "psycopg", None)
    refused = run("store", "show", "--store", place, "--blobs", "blobs").refused
    assert 'needs psycopg, which is not installed: pip install "palpate[postgresql]"' in refused
    assert "secret" not in refused


def test_the_client_of_buckets_is_named(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without obstore, likewise."""
    with open_store("store.sqlite") as store:
        store.put(squeeze())
    monkeypatch.setitem(sys.modules, "obstore.store", None)
    refused = run("store", "show", "--store", "store.sqlite", "--blobs", "s3://lab/blobs").refused
    assert 'need obstore, which is not installed: pip install "palpate[s3]"' in refused


@pytest.mark.parametrize("place", ["mysql://ann:secret@host/lab", "https://host/lab", "postgresql+psycopg2://host/lab"])
def test_an_address_of_another_kind_is_refused(run: Any, place: str) -> None:
    """What is wrong with the address of the store is told before what is missing beside it."""
    refused = run("store", "show", "--store", place).refused
    assert "expected a path, sqlite:///... or postgresql+psycopg://..." in refused
    assert "PALPATE_BLOBS" not in refused
    assert "secret" not in refused


def test_a_server_needs_a_place_for_large_bytes(run: Any) -> None:
    """Without one for a store in a server the option and the variable are named."""
    refused = run("store", "show", "--store", "postgresql+psycopg://lab@127.0.0.1:1/nowhere").refused
    assert "blobs: none were given and PALPATE_BLOBS is not set, expected a folder or s3://..." in refused
