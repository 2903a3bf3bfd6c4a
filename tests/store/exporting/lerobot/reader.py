"""A reader of the layout of LeRobot 3.0, after its published description, that checks what the description promises."""

import io
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import polars as pl
from PIL import Image

COUNTED = {
    "timestamp": "float32",
    "frame_index": "int64",
    "episode_index": "int64",
    "index": "int64",
    "task_index": "int64",
}
INFO = {
    "codebase_version", "robot_type", "total_episodes", "total_frames", "total_tasks", "chunks_size", "fps", "splits",
    "data_files_size_in_mb", "video_files_size_in_mb", "data_path", "video_path", "features",
}  # fmt: skip
EPISODES = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"


def png(value: int, size: tuple[int, int] = (8, 6), mode: str = "RGB") -> bytes:
    """An image, as a file."""
    written = io.BytesIO()
    Image.new(mode, size, (value,) * len(mode) if mode in ("RGB", "RGBA", "LA") else value).save(written, "PNG")
    return written.getvalue()


@dataclass(frozen=True)
class Episode:
    """One episode: its row in ``meta/episodes``, its task, and its frames."""

    row: dict[str, Any]
    task: str
    frames: pl.DataFrame

    def values(self, feature: str) -> np.ndarray:
        """A feature of all frames, (n, k) or (n), or for an image (n, 3, height, width) from 0 to 1."""
        column = self.frames[feature]
        if column.dtype == pl.Struct:
            images = [Image.open(io.BytesIO(each["bytes"])) for each in column]
            assert all(image.mode == "RGB" for image in images)
            return np.stack([np.asarray(image).transpose(2, 0, 1) for image in images]) / 255.0
        return np.asarray(column.to_list())


@dataclass(frozen=True)
class Dataset:
    """A data set that keeps what its description promises."""

    info: dict[str, Any]
    episodes: list[Episode]


def read(folder: Path) -> Dataset:
    """Read a data set as a program does that knows the description only, and check it."""
    info = json.loads((folder / "meta" / "info.json").read_text(encoding="utf-8"), parse_constant=refuse)
    assert set(info) == INFO
    assert info["codebase_version"] == "v3.0"
    rows = episode_rows(folder, info)
    tasks = pd.read_parquet(folder / "meta" / "tasks.parquet")
    assert tasks.index.name == "task"
    assert list(tasks.columns) == ["task_index"]
    assert list(tasks["task_index"]) == list(range(info["total_tasks"])) == list(range(len(tasks)))
    episodes = [episode(folder, info, row, tasks) for row in rows]
    check_totals(folder, info, episodes)
    check_statistics(folder, info, episodes)
    return Dataset(info, episodes)


def refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is no JSON")


def episode_rows(folder: Path, info: dict[str, Any]) -> list[dict[str, Any]]:
    """All rows about episodes; each says rightly in which file it is."""
    found = []
    for path in sorted((folder / "meta" / "episodes").rglob("*.parquet")):
        for row in pl.read_parquet(path).to_dicts():
            where = {"chunk_index": row["meta/episodes/chunk_index"], "file_index": row["meta/episodes/file_index"]}
            assert folder / EPISODES.format(**where) == path
            assert where["file_index"] < info["chunks_size"]
            found.append(row)
    assert [row["episode_index"] for row in found] == list(range(info["total_episodes"]))
    return found


def episode(folder: Path, info: dict[str, Any], row: dict[str, Any], tasks: pd.DataFrame) -> Episode:
    """The frames of an episode, found by the template of the path and by their numbers."""
    where = {"chunk_index": row["data/chunk_index"], "file_index": row["data/file_index"]}
    table = pl.read_parquet(folder / info["data_path"].format(**where))
    check_schema(table, info["features"])
    first, end = row["dataset_from_index"], row["dataset_to_index"]
    frames = table.filter((pl.col("index") >= first) & (pl.col("index") < end))
    count = row["length"]
    assert len(frames) == end - first == count > 0
    assert frames["index"].to_list() == list(range(first, end))
    assert frames["frame_index"].to_list() == list(range(count))
    assert frames["episode_index"].to_list() == [row["episode_index"]] * count
    np.testing.assert_allclose(frames["timestamp"], np.arange(count) / info["fps"], rtol=1e-6)
    (task,) = row["tasks"]
    assert frames["task_index"].to_list() == [tasks.loc[task].task_index] * count
    return Episode(row, task, frames)


def check_schema(table: pl.DataFrame, features: dict[str, Any]) -> None:
    """Each feature is a column of its kind, and there is no other."""
    assert set(table.columns) == set(features)
    for name, feature in features.items():
        assert "/" not in name
        kind, shape = table.schema[name], feature["shape"]
        if name in COUNTED:
            assert (feature["dtype"], shape, feature["names"]) == (COUNTED[name], [1], None)
        if feature["dtype"] == "image":
            assert kind == pl.Struct({"bytes": pl.Binary, "path": pl.String})
            assert feature["names"] == ["height", "width", "channels"]
            assert shape[2] == 3
            continue
        number = {"float32": pl.Float32, "int64": pl.Int64}[feature["dtype"]]
        assert kind == (number if shape == [1] else pl.Array(number, shape[0]))
        assert name in COUNTED or len(feature["names"]) == shape[0]


def check_totals(folder: Path, info: dict[str, Any], episodes: list[Episode]) -> None:
    """Episodes follow one another without a gap, and totals are right."""
    assert info["splits"] == {"train": f"0:{len(episodes)}"}
    ends = [0, *(each.row["dataset_to_index"] for each in episodes)]
    assert [each.row["dataset_from_index"] for each in episodes] == ends[:-1]
    files = list((folder / "data").rglob("*.parquet"))
    assert sum(len(pl.read_parquet(path)) for path in files) == ends[-1] == info["total_frames"]
    assert {each.task for each in episodes} == set(pd.read_parquet(folder / "meta" / "tasks.parquet").index)


def check_statistics(folder: Path, info: dict[str, Any], episodes: list[Episode]) -> None:
    """Statistics of each episode, and of all, are those of the frames."""
    found = json.loads((folder / "meta" / "stats.json").read_text(encoding="utf-8"), parse_constant=refuse)
    assert set(found) == set(info["features"])
    for name in info["features"]:
        values = [each.values(name) for each in episodes]
        for each, own in zip(episodes, values, strict=True):
            check_feature({key: each.row[f"stats/{name}/{key}"] for key in found[name]}, own)
            if own.ndim == 4:
                assert list(own.shape[1:]) == [3, *info["features"][name]["shape"][:2]]
        check_feature(found[name], np.concatenate(values))


def check_feature(found: dict[str, Any], values: np.ndarray) -> None:
    assert set(found) == {"min", "max", "mean", "std", "count"}
    assert found["count"] == [len(values)]
    axes = (0, 2, 3) if values.ndim == 4 else 0
    shape = (3, 1, 1) if values.ndim == 4 else values.reshape(len(values), -1).shape[1:]
    for name in ("min", "max", "mean", "std"):
        expected = getattr(np, name)(values.astype(np.float64), axis=axes).reshape(shape)
        assert np.shape(found[name]) == shape
        scale = max(1.0, float(np.abs(values).max()))
        np.testing.assert_allclose(found[name], expected, rtol=1e-6, atol=1e-9 * scale)
