"""Stores whose file was changed by other hands: every command ends with one sentence, and never with a traceback."""

import csv
import json
import shutil
import sqlite3
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pyarrow.parquet import read_table

from palpate.store import schema
from palpate.store.describing import change_thing, keep_image
from palpate.store.entries import Distribution
from palpate.store.keeping_episodes import put_episode
from palpate.store.opening import open_store
from palpate.store.records import Channel, FileItem, Series, ThingRef
from tests.store.made_up import made_episode, squeeze

SEED = 20240501
BYTES = np.random.default_rng(0).integers(0, 255, 100_000, dtype=np.uint8)
WRONG = ("NULL", "7", "'mug'", "x'00ff'", "'{}'", "'[1]'", "1e300", "CAST(x'ff7b' AS TEXT)")
"""What a cell may hold, whatever its column says."""
SHARED = {"owner": "Our lab", "licence": "CC-BY-4.0", "visibility": "public"}
Command = tuple[str, ...]
EVERY: tuple[Command, ...] = (
    ("show",),
    ("show", "RECORDING"),
    ("list",),
    ("list", "--json", "--property", "elasticity"),
    ("list", "--format", "csv"),
    ("table", "--json"),
    ("curves", "--gripper", "two_finger", "-o", "OUT.npz"),
    ("devices",),
    ("units",),
    ("objects", "--json"),
    ("objects",),
    ("object", "show", "object0"),
    ("object", "show", "made_up/object0", "--json", "--images", "OUT"),
    ("episodes",),
    ("episode", "EPISODE"),
    ("verify",),
    ("export", "OUT"),
    ("export", "OUT", "--format", "parquet"),
    ("repair",),
)


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, str]]:
    """A small store with a row in each table that is used, and the ids of what is in it."""
    place = tmp_path_factory.mktemp("whole") / "store.sqlite"
    sound = Series("microphone", (Channel("sound", "level", None, BYTES, rate_hz=44100.0),))
    picture = FileItem("cam0.png", "image/png", b"a picture")
    with open_store(place) as store:
        recordings = [squeeze(number, **SHARED) for number in range(4)]
        recordings.append(squeeze(5, series=(sound,), files=(picture,), log="said", notices=("odd",), **SHARED))
        store.put_many(recordings)
        episode = put_episode(store, made_episode(*recordings[:2], stop="enough"))
        image = keep_image(store, "front.png", "image/png", b"another picture")
        wood = Distribution("material", {"wood": 1.0})
        change_thing(store, ThingRef("made_up", "object0"), lambda one: one.showing(image).knowing(wood, "ann"))
    with sqlite3.connect(place) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
    connection.close()
    return place, {"RECORDING": str(recordings[4].id), "EPISODE": str(episode.id)}


@pytest.fixture
def check(run: Any, whole: tuple[Path, dict[str, str]], tmp_path: Path) -> Callable[..., None]:
    """Damage a copy of the store, and read it by some commands: none ends with a traceback."""
    place, ids = whole

    def checked(what: object, damage: Callable[[Path], None], commands: Iterable[Command] = EVERY) -> None:
        folder = tmp_path / "damaged"
        shutil.copytree(place.parent, folder)
        damage(folder / place.name)
        words = {**ids, "OUT": folder / "out", "OUT.npz": folder / "out.npz"}
        for command in commands:
            done = run("store", *(words.get(word, word) for word in command), "--store", folder / place.name)
            codes = (0, 1, 2) if command[0] in ("verify", "repair") else (0, 2)
            assert done.code in codes, (what, command, done)
            # a list has a line for each row that is left out
            assert bool(done.err) is (done.code == 2), (what, command, done)
            assert done.err.count("\n") == 1 or command[0] in ("list", "show", "objects") or not done.err, (
                what,
                command,
                done,
            )
            shutil.rmtree(folder / "out", ignore_errors=True)
        shutil.rmtree(folder)

    return checked


def statements(*lines: str) -> Callable[[Path], None]:
    """What carries out SQL past all that guards a store."""

    def damage(path: Path) -> None:
        connection = sqlite3.connect(path, isolation_level=None)
        for line in ("PRAGMA foreign_keys = OFF", "PRAGMA ignore_check_constraints = ON", *lines):
            # a column that may not be NULL, or has to be unique, is one that SQLite guards itself
            try:
                connection.execute(line)
            except sqlite3.IntegrityError:
                assert line.startswith("UPDATE")
        connection.close()

    return damage


@pytest.mark.parametrize("table", [*schema.metadata.tables, "alembic_version"])
def test_a_table_that_is_dropped(check: Callable[..., None], table: str) -> None:
    """Without a table what needs it says so, and the rest is told."""
    check(table, statements(f"DROP TABLE {table}"))


@pytest.mark.parametrize("table", [name for name in schema.metadata.tables if name not in ("users", "tokens")])
def test_cells_that_hold_something_else(check: Callable[..., None], table: str) -> None:
    """Whatever stands in a cell, it is read as what it should be or told."""
    rng = np.random.default_rng(SEED)
    columns = [column.name for column in schema.metadata.tables[table].columns]
    for name in columns:
        value = WRONG[int(rng.integers(len(WRONG)))]
        line = f"UPDATE {table} SET {name} = {value} WHERE rowid = (SELECT min(rowid) FROM {table})"
        if table in ("series", "entries", "senders"):
            line = f"UPDATE {table} SET {name} = {value} WHERE recording_id = 1"
        check(line, statements(line), some(rng))


def some(rng: np.random.Generator) -> list[Command]:
    """Some of the commands, as all of them with every damage take minutes."""
    return [EVERY[place] for place in rng.permutation(len(EVERY))[:4]]


def test_documents_that_are_json_and_something_else(check: Callable[..., None]) -> None:
    """JSON of another form than was written is no more than what cannot be read."""
    rng = np.random.default_rng(SEED)
    for table, column in (
        ("recordings", "document"),
        ("setups", "document"),
        ("layouts", "document"),
        ("thing_properties", "document"),
        ("things", "attributes"),
        ("things", "aliases"),
        ("audit", "detail"),
        ("episodes", "document"),
    ):
        for text in ('{"kind":"value","property":"mass","value":"mug"}', "[[1]]", "{"):
            line = f"UPDATE {table} SET {column} = '{text}'"
            check(line, statements(line), some(rng))


def test_bytes_that_are_flipped(check: Callable[..., None]) -> None:
    """Wherever in the file bytes are changed, nothing that is worse than a sentence follows."""
    rng = np.random.default_rng(SEED)
    for number in range(24):
        check(f"flip {number}", lambda path: flip(path, rng), some(rng))


def flip(path: Path, rng: np.random.Generator) -> None:
    """Change some bytes beside each other, past the header that says what the file is."""
    data = bytearray(path.read_bytes())
    start = int(rng.integers(100, len(data) - 64))
    length = int(rng.integers(1, 64))
    data[start : start + length] = rng.integers(0, 256, length, dtype=np.uint8).tobytes()
    path.write_bytes(bytes(data))


def test_a_list_leaves_out_what_is_damaged(run: Any, whole: tuple[Path, dict[str, str]], tmp_path: Path) -> None:
    """A recording that was changed is told with code 2 and is not in the list; the others are."""
    place, ids = whole
    shutil.copytree(place.parent, tmp_path / "damaged")
    path = tmp_path / "damaged" / place.name
    statements("UPDATE recordings SET document = replace(document, '45.0', '54.0') WHERE id = 5")(path)
    listed = run("store", "list", "--json", "--store", path)
    assert (listed.code, len(json.loads(listed.out)["recordings"])) == (2, 4)
    assert f"palpate: recording {ids['RECORDING']}: is not what was written" in listed.err
    shown = run("store", "show", "--store", path)
    assert (shown.code, "object0" in shown.out, "is not what was written" in shown.err) == (2, True, True)


@pytest.mark.parametrize(
    "damage",
    ["document = replace(document, '45.0', '54.0')", "document = CAST(x'ff7b' AS TEXT)", "gripper = x'00'"],
)
def test_tables_of_results_leave_out_what_is_damaged(
    run: Any, whole: tuple[Path, dict[str, str]], tmp_path: Path, damage: str
) -> None:
    """CSV and Parquet have the results of the others, and the code is 2; a whole store has them all, and it is 0."""
    place, ids = whole
    expected = results(run, place, tmp_path / "whole.parquet", code=0)
    shutil.copytree(place.parent, tmp_path / "damaged")
    path = tmp_path / "damaged" / place.name
    statements(f"UPDATE recordings SET {damage} WHERE id = 5")(path)
    found = results(run, path, tmp_path / "damaged.parquet", code=2, named=ids["RECORDING"])
    assert found == [row for row in expected if row["recording"] != ids["RECORDING"]]
    assert len(found) < len(expected)


def results(run: Any, place: Path, file: Path, *, code: int, named: str | None = None) -> list[dict[str, Any]]:
    """What is written as Parquet, and the same as CSV."""
    for form, output in (("parquet", file), ("csv", file.with_suffix(".csv"))):
        done = run("store", "list", "--format", form, "--output", output, "--store", place)
        assert (done.code, done.out, done.err.count("\n")) == (code, "", 0 if named is None else 1)
        assert named is None or done.err.startswith(f"palpate: recording {named}: ")
    rows: list[dict[str, Any]] = read_table(file).to_pylist()
    with file.with_suffix(".csv").open(encoding="utf-8", newline="") as opened:
        assert [row["recording"] for row in csv.DictReader(opened)] == [row["recording"] for row in rows]
    return rows


@pytest.mark.parametrize("attributes", ["CAST(x'7b226180223a347d' AS TEXT)", "'3'"], ids=["no text", "no names"])
def test_an_object_that_is_damaged_hides_no_other(
    run: Any, whole: tuple[Path, dict[str, str]], tmp_path: Path, attributes: str
) -> None:
    """It is named with code 2 and left out of the objects; its recordings and what was measured of it are there."""
    place, _ = whole
    shutil.copytree(place.parent, tmp_path / "damaged")
    path = tmp_path / "damaged" / place.name
    statements(f"UPDATE things SET attributes = {attributes} WHERE name = 'object1'")(path)
    damaged = "palpate: object made_up/object1: "
    objects = run("store", "objects", "--json", "--store", path)
    assert (objects.code, [one["id"] for one in json.loads(objects.out)]) == (2, ["object0", "object2"])
    assert (objects.err.startswith(damaged), objects.err.count("\n")) == (True, 1)
    shown = run("store", "show", "--store", path)
    assert (shown.code, shown.err.startswith(damaged), shown.err.count("\n")) == (2, True, 1)
    assert "5 recordings of 2 objects" in shown.out
    table = run("store", "table", "--json", "--store", path)
    assert (table.code, {cell["thing"] for cell in json.loads(table.out)}) == (0, {"object0", "object1", "object2"})
