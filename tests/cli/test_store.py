import json
from pathlib import Path
from typing import Any

import pytest
import typer

from palpate.cli import store as command
from palpate.cli.store_view import entry_words
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.opening import open_store
from palpate.store.records import FileItem
from tests.store.made_up import squeeze
from tests.store.places import damage


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store with four recordings, which the commands find by the environment."""
    path = tmp_path / "store.sqlite"
    monkeypatch.setenv("PALPATE_STORE", str(path))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    with open_store(path) as store:
        store.put_many([squeeze(number, notices=("it was odd",) if number == 1 else ()) for number in range(4)])
    return path


def test_show_tells_what_is_there(run: Any, place: Path) -> None:
    """The overview names objects, setups, results and what was odd."""
    shown = run("store", "show")
    assert shown.code == 0
    told = " ".join(shown.out.split())
    for text in (
        "4 recordings of 3 objects",
        "object2",
        "gripper two_finger",
        "squeezing elasticity",
        "41.0 ±",
        "it was odd",
    ):
        assert text in told


def test_show_of_an_empty_store(run: Any, tmp_path: Path) -> None:
    """A store without recordings says so."""
    open_store(tmp_path / "new.sqlite").close()
    assert "0 recordings of 0 objects" in run("store", "show", "--store", tmp_path / "new.sqlite").out


def test_list_filters_and_pages(run: Any, place: Path) -> None:
    """Options filter, and the cursor that is printed gives the next page."""
    first = json.loads(run("store", "list", "--limit", 3, "--json").out)
    second = json.loads(run("store", "list", "--limit", 3, "--cursor", first["cursor"], "--json").out)
    assert len({row["id"] for row in (*first["recordings"], *second["recordings"])}) == 4
    assert "more: --cursor" in run("store", "list", "--limit", 3).out
    assert len(json.loads(run("store", "list", "--object", "object0", "--json").out)["recordings"]) == 2
    assert not json.loads(run("store", "list", "--until", "2020-01-01", "--json").out)["recordings"]


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("--since", "soon", "--since: 'soon' was found, expected a date or time"),
        ("--label", "wood", "--label: 'wood' was found, expected PROPERTY=LABEL"),
        ("--sort", "size", "--sort: 'size' was found; choose from"),
        ("--cursor", "mug", "cursor: 'mug'"),
        ("--setup", "mug", "setup 'mug': is not the beginning of a digest"),
    ],
)
def test_bad_options_are_refused(run: Any, place: Path, option: str, value: str, message: str) -> None:
    """A bad option is one sentence on standard error, and exit code 2."""
    assert message in run("store", "list", option, value).refused


def test_verify_and_repair_tell_faults(run: Any, place: Path) -> None:
    """A whole store verifies with code 0; a fault is told with code 1, and what could be mended is gone afterwards."""
    assert run("store", "verify").out == "all is as it was written\n"
    with open_store(place) as store, store.engine.begin() as connection:
        connection.exec_driver_sql("DELETE FROM entries WHERE recording_id = 2")
    found = run("store", "verify")
    assert (found.code, found.out.splitlines()[-1]) == (1, "1 fault; palpate store repair mends 1")
    mended = run("store", "repair")
    assert (mended.code, mended.out.splitlines()[-1]) == (0, "1 fault: 1 mended")
    assert "its content: the rows for queries were made again" in mended.out
    assert run("store", "verify").code == 0


def test_many_faults_of_one_kind_are_counted(run: Any, place: Path) -> None:
    """Some that are alike are named, the others counted."""
    with open_store(place) as store:
        store.put_many([squeeze(number) for number in range(10, 20)])
        with store.engine.begin() as connection:
            connection.exec_driver_sql("DELETE FROM entries")
    lines = run("store", "verify").out.splitlines()
    assert len(lines) == 7
    assert lines[-2:] == [
        "and 9 more of recording: rows for queries are not those of its content",
        "14 faults; palpate store repair mends 14",
    ]


def test_a_lost_and_a_damaged_file_come_back_by_an_import(run: Any, place: Path, tmp_path: Path) -> None:
    """One fault each, with what needs it; repair tells what it did and what is left, and an import mends it."""
    archive, pictures = tmp_path / "archive", [FileItem("cam0", "image/png", b"%d" % number) for number in range(2)]
    recordings = [squeeze(20 + number, files=(picture,)) for number, picture in enumerate(pictures)]
    with open_store(place) as store:
        store.put_many(recordings)
        assert run("store", "export", archive).code == 0
        for picture, data in zip(pictures, (None, b"another"), strict=True):
            damage(store.blobs, picture.sha256, data)
    refused = run("store", "export", tmp_path / "second").refused
    assert "export: 2 recordings not as written" in refused
    left_out = run("store", "export", tmp_path / "second", "--leave-out-damaged").out.splitlines()
    assert (left_out[0], len(left_out)) == (f"{tmp_path / 'second'}: 4 recordings", 3)
    found = run("store", "verify").out.splitlines()
    told = {line.partition(":")[0]: line for line in found[:2]}
    for picture, recording in zip(pictures, recordings, strict=True):
        assert told[f"blob {picture.sha256}"].endswith(f"; needed by recording {recording.id}")
    assert found[2] == "2 faults; palpate store repair sets 1 aside"
    mended = run("store", "repair")
    assert (mended.code, mended.out.splitlines()[2]) == (1, "2 faults: 1 set aside, 1 left")
    again = run("store", "import", archive)
    assert (again.code, again.out) == (0, "2 mended, 0 new, 4 there already, 0 refused, 0 skipped\n")
    assert run("store", "verify").code == 0


def test_an_archive_goes_to_another_store(run: Any, place: Path, tmp_path: Path) -> None:
    """What was exported is imported elsewhere, once; an existing folder is not written to."""
    archive, other = tmp_path / "archive", tmp_path / "other.sqlite"
    assert run("store", "export", archive).out == f"{archive}: 4 recordings\n"
    assert "4 new, 0 there already, 0 refused" in run("store", "import", archive, "--store", other).out
    assert "0 new, 4 there already, 0 refused" in run("store", "import", archive, "--store", other).out
    assert "exists already" in run("store", "export", archive).refused


@pytest.mark.parametrize(
    ("entry", "words"),
    [
        (Value("mass", 1.0), "mass 1.00 (unit not stated)"),
        (Interval("mass", 1.0, 2.0, "g"), "mass 1.00 to 2.00 g"),
        (Bound("mass", below=2.0, unit="g"), "mass below 2.00 g"),
        (Distribution("kind", {"a": 0.5, "b": 0.3, "c": 0.2}), "kind a 0.50, b 0.30, ..."),
        (FailedEntry("slipped"), "all failed: slipped"),
    ],
)
def test_entries_in_words(entry: Entry, words: str) -> None:
    """Each kind of result reads well."""
    assert entry_words(entry) == words


def test_every_command_is_there() -> None:
    """The group has its commands, and one object has its own."""
    commands = getattr(typer.main.get_command(command.app), "commands", {})
    kept = {"show", "list", "verify", "repair", "export", "import", "units", "unit", "share"}
    assert set(commands) == kept | {"table", "curves", "devices", "objects", "object", "episodes", "episode", "schema"}
    assert set(commands["object"].commands) == {"show", "add", "set", "know", "forget", "merge", "split", "undo"}


def test_what_is_not_installed_is_named(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the extra the command says in one sentence what to install, and does nothing."""
    monkeypatch.setattr("palpate.cli.storing.find_spec", lambda name: None if name == "sqlalchemy" else object())
    refused = run("store", "show").refused
    assert 'palpate store needs sqlalchemy, which is not installed: pip install "palpate[store]"' in refused


def test_a_path_that_is_not_there(run: Any, tmp_path: Path) -> None:
    """Nothing is imported, and no store is made, where one of the paths does not exist."""
    refused = run("store", "import", str(tmp_path / "nowhere"), "--store", str(tmp_path / "s.sqlite")).refused
    assert "nowhere: no such file or folder" in refused
    assert not (tmp_path / "s.sqlite").exists()
