import json
import math
import shutil
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import duckdb
import numpy as np
import pandas as pd
import polars as pl
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.errors import DamagedError, StoreError
from palpate.store.exporting.tables import Tables
from palpate.store.exporting.writing import export
from palpate.store.merging import merge_things
from palpate.store.opening import open_store
from palpate.store.records import FileItem, Recording, ThingRef
from palpate.store.store import Store
from tests.store.exporting.shared import TERMS, public, written
from tests.store.made_up import recordings, squeeze

Rows = list[dict[str, Any]]


def with_pandas(folder: Path, table: str) -> Rows:
    files = sorted((folder / "data").glob(f"{table}-*.parquet"))
    rows: list[Any] = [row for path in files for row in pd.read_parquet(path).to_dict("records")]
    return rows


def with_polars(folder: Path, table: str) -> Rows:
    return pl.read_parquet(folder / "data" / f"{table}-*.parquet").to_dicts()


def with_duckdb(folder: Path, table: str) -> Rows:
    with duckdb.connect() as connection:
        asked = connection.execute(f"SELECT * FROM '{folder}/data/{table}-*.parquet'")
        names = [column[0] for column in asked.description or []]
        return [dict(zip(names, row, strict=True)) for row in asked.fetchall()]


READERS = [with_pandas, with_polars, with_duckdb]


def nothing(value: object) -> bool:
    return value is None or value is pd.NaT or (isinstance(value, float) and math.isnan(value))


def same(found: object, expected: object) -> bool:
    """Whether a reader gave what was recorded; nothing is None, NaN or NaT, as the reader has it."""
    if expected is None:
        return nothing(found)
    if isinstance(expected, list | tuple | np.ndarray):
        return (
            isinstance(found, list | np.ndarray)
            and len(found) == len(expected)
            and all(same(one, other) for one, other in zip(found, expected, strict=True))
        )
    if isinstance(expected, float | np.floating) and math.isnan(expected):
        return nothing(found)
    return bool(found == expected)


def channels_of(made: list[Recording]) -> Iterator[dict[str, Any]]:
    """What the table of channels is to hold, straight from the recordings."""
    for recording in made:
        for series in recording.series:
            for channel in series.channels:
                yield {
                    "recording": str(recording.id),
                    "series": series.name,
                    "channel": channel.name,
                    "quantity": channel.quantity,
                    "unit": channel.unit,
                    "rate_hz": channel.rate_hz,
                    "time_s": channel.time_s,
                    "values": [float(value) for value in channel.values.flatten()],
                    "sample_shape": channel.values.shape[1:],
                }


def entry_of(entry: Entry) -> dict[str, Any]:
    """What a row of results is to say, by kind."""
    match entry:
        case Value():
            return {"kind": "value", "value": entry.value, "sd": entry.sd, "unit": entry.unit, "label": None}
        case Distribution():
            labels = sorted(entry.probabilities)
            items = {"labels": labels, "probabilities": [entry.probabilities[label] for label in labels]}
            return {"kind": "distribution", "value": None, "unit": None, **items}
        case Interval():
            return {"kind": "interval", "low": entry.low, "high": entry.high, "unit": entry.unit, "value": None}
        case Bound():
            return {"kind": "bound", "low": entry.above, "high": entry.below, "unit": entry.unit, "value": None}
        case FailedEntry():
            return {"kind": "failed", "reason": entry.reason, "value": None}


def entries_of(made: list[Recording]) -> Iterator[dict[str, Any]]:
    for recording in made:
        for position, entry in enumerate(recording.entries):
            head = {"recording": str(recording.id), "position": position, "property": entry.property}
            yield {**head, "action": recording.action, "object": recording.thing.id, **entry_of(entry)}


def is_embargoed(recording: Recording) -> bool:
    return recording.embargoed_until is not None and recording.embargoed_until > datetime.now(UTC)


def recordings_of(made: list[Recording]) -> Iterator[dict[str, Any]]:
    for recording in made:
        pose, gripper = recording.object_pose, recording.setup.gripper
        yield {
            "recording": str(recording.id),
            "digest": recording.digest,
            "action": recording.action,
            "dataset": recording.thing.dataset,
            "object": recording.thing.id,
            "gripper": None if gripper is None else gripper.name,
            "owner": recording.owner,
            "licence": recording.licence,
            # until an embargo ends, others see nothing
            "visibility": "private" if is_embargoed(recording) else recording.visibility,
            "ground_truth": recording.ground_truth,
            "object_position_m": None if pose is None else pose.translation_m,
            "object_quaternion": None if pose is None else pose.quaternion,
            "object_frame": None if pose is None else pose.frame,
            "log": recording.log,
            "notices": recording.notices,
        }


def check(found: Rows, expected: list[dict[str, Any]]) -> None:
    assert len(found) == len(expected)
    for row, wanted in zip(found, expected, strict=True):
        wrong = {name: (row[name], value) for name, value in wanted.items() if not same(row[name], value)}
        assert not wrong


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(made=st.lists(recordings(), min_size=1, max_size=3, unique_by=lambda each: each.digest))
def test_any_recordings_are_read_by_all(tmp_path_factory, made: list[Recording]) -> None:
    """Pandas, Polars and DuckDB read from the tables the numbers and texts that were put into the store."""
    folder = tmp_path_factory.mktemp("tables")
    with open_store(folder / "store.sqlite", durable=False) as store:
        store.put_many(made)
        written(store, Tables(TERMS), folder / "tables")
    for table, rows in (("recordings", recordings_of), ("entries", entries_of), ("channels", channels_of)):
        expected = list(rows(made))
        for read in READERS if expected else []:
            check(read(folder / "tables", table), expected)
        assert bool(expected) == bool(list((folder / "tables" / "data").glob(f"{table}-*")))
    shutil.rmtree(folder)


@pytest.mark.parametrize("read", READERS)
def test_files_are_embedded(local: Store, tmp_path: Path, read: Callable[[Path, str], Rows]) -> None:
    """Images and sounds stand as bytes with a name in tables of their own, other files in a third."""
    files = (
        FileItem("imgs/cam0.png", "image/png", b"picture"),
        FileItem("knock.wav", "audio/wav", b"knock"),
        FileItem("data/forces.json", "application/json", b"{}"),
    )
    local.put(public(1, files=files))
    written(local, Tables(), tmp_path / "tables")
    for table, column, item in (("images", "image", files[0]), ("audio", "audio", files[1])):
        (row,) = read(tmp_path / "tables", table)
        assert row[column] == {"bytes": item.data, "path": item.name.split("/")[-1]}
        assert (row["name"], row["media_type"], row["sha256"]) == (item.name, item.media_type, item.sha256)
    (row,) = read(tmp_path / "tables", "files")
    assert bytes(row["data"]) == b"{}"


def test_the_hub_is_told_what_is_an_image(local: Store, tmp_path: Path) -> None:
    """The Parquet of images says so in the words of Hugging Face datasets."""
    local.put(public(1, files=(FileItem("cam0.png", "image/png", b"picture"),)))
    written(local, Tables(), tmp_path / "tables")
    schema = pq.read_schema(tmp_path / "tables" / "data" / "images-00000-of-00001.parquet")
    assert json.loads(schema.metadata[b"huggingface"])["info"]["features"] == {"image": {"_type": "Image"}}


def test_objects_and_setups(local: Store, tmp_path: Path) -> None:
    """Each object and each device of a setup is one row; an object that was merged names the other."""
    local.put_many([public(number) for number in range(6)])
    merge_things(local, ThingRef("made_up", "object2"), ThingRef("made_up", "object0"), who="test")
    written(local, Tables(), tmp_path / "tables")
    objects = with_polars(tmp_path / "tables", "objects")
    assert [(row["object"], row["same_as_object"]) for row in objects] == [
        ("object0", None),
        ("object1", None),
        ("object2", "object0"),
    ]
    (device,) = with_polars(tmp_path / "tables", "setups")
    assert device["setup"] == squeeze(0).setup.digest
    assert (device["kind"], device["device"]) == ("gripper", "two_finger")
    assert json.loads(device["parameters_json"]) == {"stroke_mm": 85}


def test_large_tables_are_in_several_files(local: Store, tmp_path: Path) -> None:
    """Files are numbered and say how many they are, and together hold every row."""
    made = [public(number, files=(FileItem("x.bin", "application/x", bytes([number]) * 100),)) for number in range(5)]
    local.put_many(made)
    written(local, Tables(shard_bytes=1), tmp_path / "tables")
    check(with_duckdb(tmp_path / "tables", "recordings"), list(recordings_of(made)))
    names = {path.name for path in (tmp_path / "tables" / "data").iterdir()}
    assert "recordings-00000-of-00001.parquet" in names


def test_only_what_is_public_is_given(local: Store, tmp_path: Path) -> None:
    """Private recordings and those of the lab stay, and it is told; they come where that is asked for."""
    local.put_many([public(1), public(2, visibility="lab"), public(3, visibility="private")])
    told = written(local, Tables(), tmp_path / "given")
    assert told.recordings == 1
    assert told.withheld == 2
    assert [row["object"] for row in with_polars(tmp_path / "given", "recordings")] == ["object1"]
    assert written(local, Tables(replace(TERMS, include_private=True)), tmp_path / "all").recordings == 3


def test_a_failed_export_leaves_nothing(local: Store, tmp_path: Path) -> None:
    """A damaged recording, or an interrupt, ends an export without a trace of it."""
    local.put_many([public(1), public(2)])
    before = set(tmp_path.iterdir())

    def interrupt(done: int, of: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        export(local, Tables(), tmp_path / "tables", told=interrupt)
    with local.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE series SET data = x'00' WHERE recording_id = 2")
    with pytest.raises(DamagedError):
        written(local, Tables(), tmp_path / "tables")
    assert set(tmp_path.iterdir()) == before
    with pytest.raises(StoreError, match="exists already"):
        written(local, Tables(), tmp_path)
