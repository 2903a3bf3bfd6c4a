"""``meta``: what LeRobot reads before it reads frames."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pyarrow.parquet import write_table

from palpate.store.exporting.census import Census
from palpate.store.exporting.columns import Column, Table
from palpate.store.exporting.kinds import TEXT, WHOLE
from palpate.store.exporting.lerobot.episodes import CHUNK_FILES, COUNTED, STATE, EpisodeWriter
from palpate.store.exporting.shards import Shard

__all__ = ["TASKS", "robot_of", "write_meta", "write_tasks"]

VERSION = "v3.0"
VIDEO_MB = 200
TASKS = Table(
    "tasks",
    "a task",
    (Column("task_index", WHOLE, "number of the task, from 0"), Column("task", TEXT, "the action and the object")),
)


def write_meta(folder: Path, episodes: EpisodeWriter, data_mb: int, robot: str | None) -> None:
    """Write ``info.json`` and ``stats.json``.

    Parameters
    ----------
    folder
        ``meta``.
    episodes
        What was written.
    data_mb
        How large [MB] a file of frames may become.
    robot
        What measured.
    """
    _write_json(folder / "info.json", _info(episodes, data_mb, robot))
    _write_json(folder / "stats.json", {name: each.plain() for name, each in episodes.statistics.items()})


def write_tasks(folder: Path, tasks: Mapping[str, int]) -> Shard:
    """Write the tasks as pandas does where they are the index, as the layout asks for."""
    rows = TASKS.of([{"task": task, "task_index": number} for task, number in tasks.items()])
    columns = [
        {"name": "task_index", "field_name": "task_index", "pandas_type": "int64", "numpy_type": "int64"},
        {"name": "task", "field_name": "task", "pandas_type": "unicode", "numpy_type": "object"},
    ]
    mark = {
        "index_columns": ["task"],
        "column_indexes": [],
        "columns": [{**each, "metadata": None} for each in columns],
    }
    path = folder / "tasks.parquet"
    write_table(rows.replace_schema_metadata({"pandas": json.dumps(mark)}), path)
    return Shard(path, rows.num_rows)


def robot_of(census: Census) -> str | None:
    """The arm, or else the gripper, where all recordings were made with one."""
    for kind in ("arm", "gripper"):
        names = {getattr(setup, kind).name if getattr(setup, kind) else None for setup in census.setups.values()}
        if len(names) == 1 and None not in names:
            return names.pop()
    return None


def _info(episodes: EpisodeWriter, data_mb: int, robot: str | None) -> Mapping[str, Any]:
    """What ``meta/info.json`` holds."""
    return {
        "codebase_version": VERSION,
        "robot_type": robot,
        "total_episodes": episodes.episodes,
        "total_frames": episodes.frames,
        "total_tasks": len(episodes.tasks),
        "chunks_size": CHUNK_FILES,
        "data_files_size_in_mb": data_mb,
        "video_files_size_in_mb": VIDEO_MB,
        "fps": episodes.timing.fps,
        "splits": {"train": f"0:{episodes.episodes}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "features": _features(episodes),
    }


def _features(episodes: EpisodeWriter) -> Mapping[str, Any]:
    features = episodes.features
    found: dict[str, Any] = {}
    if features.signals:
        names = [name for signal in features.signals for name in signal.names]
        found[STATE] = {"dtype": "float32", "shape": [features.width], "names": names}
    for picture in features.pictures:
        shape = [picture.height, picture.width, 3]
        found[picture.key] = {"dtype": "image", "shape": shape, "names": ["height", "width", "channels"]}
    for column in COUNTED:
        dtype = "float32" if column.name == "timestamp" else "int64"
        found[column.name] = {"dtype": dtype, "shape": [1], "names": None}
    return found


def _write_json(path: Path, plain: Mapping[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(plain, indent=4, ensure_ascii=False) + "\n", encoding="utf-8")
