import json
import warnings
from pathlib import Path
from typing import Any

import polars as pl
import pytest

from palpate.store.content import file_digest
from palpate.store.entries import Distribution, Value
from palpate.store.exporting import shards
from palpate.store.exporting.lerobot.dataset import LeRobot
from palpate.store.exporting.tables import Tables
from palpate.store.records import FileItem
from palpate.store.store import Store
from tests.store.exporting.lerobot.reader import png
from tests.store.exporting.shared import public, written

# what the library does with rdflib and pandas is not ours
pytestmark = [
    pytest.mark.filterwarnings("ignore:ConjunctiveGraph is deprecated:DeprecationWarning"),
    pytest.mark.filterwarnings("ignore:The inplace keyword in DataFrame.reset_index is deprecated"),
]


def dataset(folder: Path) -> Any:
    with warnings.catch_warnings():
        # what the library imports is not ours
        warnings.simplefilter("ignore")
        import mlcroissant
    found = mlcroissant.Dataset(folder / "croissant.json")
    assert not found.metadata.issues.errors
    assert not found.metadata.issues.warnings
    return found


def records(found: Any, table: str) -> list[dict[str, Any]]:
    """Records as the library reads them, with texts as texts."""
    rows = []
    for record in found.records(table):
        row = {name.removeprefix(f"{table}/"): value for name, value in record.items()}
        rows.append(
            {name: value.decode() if type(value) is bytes and name != "data" else value for name, value in row.items()}
        )
    return rows


def test_tables_are_read_by_their_description(local: Store, tmp_path: Path) -> None:
    """The reference library accepts the description without a complaint and reads every table through it."""
    files = (FileItem("cam0.png", "image/png", png(7)), FileItem("x.bin", "application/x", b"\0\1"))
    entries = (Value("elasticity", 40.5, None, "kPa"), Distribution("material", {"wood": 0.75, "steel": 0.25}))
    made = [public(number, files=files, entries=entries) for number in range(3)]
    local.put_many(made)
    written(local, Tables(), tmp_path / "given")
    found = dataset(tmp_path / "given")
    assert {each.id for each in found.metadata.record_sets} == {
        "recordings", "entries", "channels", "objects", "setups", "images", "files",
    }  # fmt: skip
    rows = records(found, "recordings")
    assert [row["recording"] for row in rows] == [str(each.id) for each in made]
    assert [row["recorded_at"].to_pydatetime() for row in rows] == [each.recorded_at for each in made]
    assert [row["value"] for row in records(found, "entries")] == [40.5, None] * 3
    assert records(found, "entries")[1]["probabilities"] == [0.25, 0.75]
    first = made[0].series[0].channels[0]
    assert records(found, "channels")[0]["values"] == list(first.values)
    assert records(found, "images")[0]["image"].getpixel((0, 0)) == (7, 7, 7)
    assert records(found, "files")[0]["data"] == b"\0\1"
    assert len(records(found, "objects")) == 3
    assert len(records(found, "setups")) == 1


def test_tables_in_several_files(local: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All files of a table are read through the description, in order."""
    monkeypatch.setattr(shards, "GROUP_ROWS", 1)
    made = [public(number, files=(FileItem("x.bin", "application/x", b"x"),)) for number in range(3)]
    local.put_many(made)
    written(local, Tables(shard_bytes=1), tmp_path / "given")
    assert len(list((tmp_path / "given" / "data").glob("recordings-*-of-00003.parquet"))) == 3
    assert [row["recording"] for row in records(dataset(tmp_path / "given"), "recordings")] == [
        str(each.id) for each in made
    ]


def test_a_changed_file_is_refused(local: Store, tmp_path: Path) -> None:
    """The reference library finds by the description that a file is another one."""
    local.put(public(1))
    written(local, Tables(), tmp_path / "given")
    path = tmp_path / "given" / "data" / "objects-00000-of-00001.parquet"
    path.write_bytes(path.read_bytes() + b"x")
    with pytest.raises(Exception, match="Download"):
        records(dataset(tmp_path / "given"), "objects")


def test_files_are_described(local: Store, tmp_path: Path) -> None:
    """The description holds the path, the SHA-256 and the size of each file."""
    local.put(public(1))
    written(local, Tables(), tmp_path / "given")
    plain = json.loads((tmp_path / "given" / "croissant.json").read_text(encoding="utf-8"))
    files = [each for each in plain["distribution"] if each["@type"] == "cr:FileObject"]
    assert {each["contentUrl"] for each in files} == {
        path.relative_to(tmp_path / "given").as_posix() for path in (tmp_path / "given").rglob("*.parquet")
    }
    for each in files:
        path = tmp_path / "given" / each["contentUrl"]
        assert each["sha256"] == file_digest(path)
        assert each["contentSize"] == f"{path.stat().st_size} B"


def test_frames_are_read_by_their_description(local: Store, tmp_path: Path) -> None:
    """The reference library reads frames, episodes and tasks of the other layout too."""
    local.put_many([public(number, files=(FileItem("cam0.png", "image/png", png(7)),)) for number in range(2)])
    written(local, LeRobot(fps=5), tmp_path / "given")
    found = dataset(tmp_path / "given")
    frames, table = records(found, "frames"), pl.read_parquet(tmp_path / "given" / "data" / "**" / "*.parquet")
    assert [row["index"] for row in frames] == table["index"].to_list()
    assert [list(row["observation.state"]) for row in frames] == [list(row) for row in table["observation.state"]]
    assert [row["length"] for row in records(found, "episodes")] == table["episode_index"].value_counts(sort=True).sort(
        "episode_index"
    )["count"].to_list()
    assert [row["task"] for row in records(found, "tasks")] == ["squeezing object0", "squeezing object1"]
