"""Recordings as episodes: frames in ``data``, and a row about each in ``meta/episodes``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from palpate.store.content import entry_plain, to_json
from palpate.store.errors import StoreError
from palpate.store.exporting.columns import Column, Table
from palpate.store.exporting.kinds import IMAGE, TEXT, TEXTS, WHOLE, Kind, vector
from palpate.store.exporting.lerobot.features import Features
from palpate.store.exporting.lerobot.frames import Timing, state_of
from palpate.store.exporting.lerobot.pictures import Pixels, pixels_of
from palpate.store.exporting.lerobot.statistics import Moments, image_moments, moments
from palpate.store.exporting.shards import GROUP_BYTES, GROUP_ROWS, ShardWriter
from palpate.store.records import Recording

__all__ = ["CHUNK_FILES", "COUNTED", "EPISODES", "STATE", "EpisodeWriter", "chunked", "episodes_schema", "frames_table"]

CHUNK_FILES = 1000
ROWS_AT_ONCE = 500
STATE = "observation.state"
SHORT = Kind("number", pa.float32(), "sc:Float")
COUNTED = (
    Column("timestamp", SHORT, "time since the first frame of the episode [s]"),
    Column("frame_index", WHOLE, "number of the frame in its episode, from 0"),
    Column("episode_index", WHOLE, "number of the episode, from 0"),
    Column("index", WHOLE, "number of the frame, from 0"),
    Column("task_index", WHOLE, "number of the task, as in the table tasks"),
)
EPISODES = Table(
    "episodes",
    "an episode, which is one recording",
    (
        Column("episode_index", WHOLE, "number of the episode, from 0"),
        Column("tasks", TEXTS, "what was to be done: the action and the object"),
        Column("length", WHOLE, "how many frames it has"),
        Column("data/chunk_index", WHOLE, "number of the folder in data where its frames are"),
        Column("data/file_index", WHOLE, "number of the file in that folder"),
        Column("dataset_from_index", WHOLE, "number of its first frame"),
        Column("dataset_to_index", WHOLE, "number of the frame after its last"),
        Column("meta/episodes/chunk_index", WHOLE, "number of the folder in meta/episodes where this row is"),
        Column("meta/episodes/file_index", WHOLE, "number of the file in that folder"),
        Column("recording", TEXT, "id of the recording"),
        Column("results_json", TEXT, "the results of the measurement"),
    ),
)


def frames_table(features: Features) -> Table:
    """The columns of the frames."""
    columns = [Column(picture.key, IMAGE, f"the image {picture.file}") for picture in features.pictures]
    if features.signals:
        named = "; ".join(name for signal in features.signals for name in signal.names)
        columns.insert(0, Column(STATE, vector(features.width), f"in this order: {named}"))
    return Table("frames", "a frame", (*columns, *COUNTED))


def chunked(folder: Path, number: int) -> Path:
    """Where the file of a number is."""
    return folder / f"chunk-{number // CHUNK_FILES:03}" / f"file-{number % CHUNK_FILES:03}.parquet"


class EpisodeWriter:
    """Writes recordings as episodes and counts as it goes; `finish` comes last.

    Parameters
    ----------
    features, timing
        What a frame holds, and when there is one.
    data, meta
        Where frames and rows about episodes go.
    """

    def __init__(self, features: Features, timing: Timing, data: ShardWriter, meta: ShardWriter) -> None:
        self.features, self.timing, self.data, self.meta = features, timing, data, meta
        self.table = frames_table(features)
        self.tasks: dict[str, int] = {}
        self.statistics: dict[str, Moments] = {}
        self.episodes = self.frames = 0
        self._rows: list[Mapping[str, Any]] = []

    def write(self, recording: Recording) -> None:
        """Add a recording as the next episode.

        Raises
        ------
        StoreError
            If it cannot be one; nothing was written then.
        """
        state = state_of(recording, self.features.signals, self.timing)
        images = {picture.key: _pixels(recording, picture.file) for picture in self.features.pictures}
        numbers = self._numbers(len(state), self.tasks.setdefault(_task(recording), len(self.tasks)))
        found = _statistics(state, images, numbers)
        row = self._row(recording, len(state), found)
        self.data.write(self._parts(state, images, numbers))
        self._rows.append(row)
        if len(self._rows) == ROWS_AT_ONCE:
            self.finish()
        for name, each in found.items():
            self.statistics[name] = self.statistics[name].merged(each) if name in self.statistics else each
        self.episodes, self.frames = self.episodes + 1, self.frames + len(state)

    def finish(self) -> None:
        """Write the rows that wait."""
        self.meta.write([pa.Table.from_pylist(self._rows, self.meta.schema)])
        self._rows = []

    def _numbers(self, length: int, task: int) -> Mapping[str, NDArray[Any]]:
        frame = np.arange(length)
        return {
            "timestamp": (frame / self.timing.fps).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(length, self.episodes),
            "index": self.frames + frame,
            "task_index": np.full(length, task),
        }

    def _row(self, recording: Recording, length: int, found: Mapping[str, Moments]) -> Mapping[str, Any]:
        data, meta = self.data.begin(), self.meta.begin()
        row = {
            "episode_index": self.episodes,
            "tasks": [_task(recording)],
            "length": length,
            "data/chunk_index": data // CHUNK_FILES,
            "data/file_index": data % CHUNK_FILES,
            "dataset_from_index": self.frames,
            "dataset_to_index": self.frames + length,
            "meta/episodes/chunk_index": meta // CHUNK_FILES,
            "meta/episodes/file_index": meta % CHUNK_FILES,
            "recording": str(recording.id),
            "results_json": to_json([entry_plain(entry) for entry in recording.entries]),
        }
        for name, each in found.items():
            row |= {f"stats/{name}/{key}": value for key, value in each.plain().items()}
        return row

    def _parts(
        self, state: NDArray[np.float32], images: Mapping[str, Pixels], numbers: Mapping[str, NDArray[Any]]
    ) -> Iterator[pa.Table]:
        """The frames, in parts that are not too large."""
        size = sum(len(image.encoded) for image in images.values())
        step = max(1, min(GROUP_ROWS, GROUP_BYTES // max(1, size)))
        for first in range(0, len(state), step):
            part = slice(first, first + step)
            columns = {name: pa.array(values[part]) for name, values in numbers.items()}
            if self.features.signals:
                columns[STATE] = _vectors(state[part])
            for picture in self.features.pictures:
                held = {"bytes": images[picture.key].encoded, "path": picture.file.rpartition("/")[2]}
                columns[picture.key] = pa.array([held] * len(state[part]), IMAGE.arrow)
            schema = self.data.schema
            yield pa.Table.from_arrays(
                [columns[name].cast(schema.field(name).type) for name in schema.names], schema=schema
            )


def episodes_schema(table: Table) -> pa.Schema:
    """The columns of ``meta/episodes``: those of all data sets, and statistics of each feature of this one."""
    schema = EPISODES.schema
    for column in table.columns:
        number: pa.DataType = pa.list_(pa.float64())
        if column.kind is IMAGE:
            number = pa.list_(pa.list_(number))
        for name in ("min", "max", "mean", "std"):
            schema = schema.append(pa.field(f"stats/{column.name}/{name}", number))
        schema = schema.append(pa.field(f"stats/{column.name}/count", pa.list_(pa.int64())))
    return schema


def _task(recording: Recording) -> str:
    return f"{recording.action} {recording.thing.common_name or recording.thing.id}"


def _pixels(recording: Recording, name: str) -> Pixels:
    for item in recording.files:
        if item.name == name:
            return pixels_of(name, item.data if isinstance(item.data, bytes) else item.data.read_bytes())
    raise StoreError(f"{name} is not in it")


def _statistics(
    state: NDArray[np.float32], images: Mapping[str, Pixels], numbers: Mapping[str, NDArray[Any]]
) -> dict[str, Moments]:
    found = {name: moments(values.reshape(-1, 1)) for name, values in numbers.items()}
    found |= {name: image_moments(image.values, len(state)) for name, image in images.items()}
    return {STATE: moments(state), **found} if state.shape[1] else found


def _vectors(state: NDArray[np.float32]) -> pa.Array:
    if state.shape[1] == 1:
        return pa.array(state[:, 0])
    return pa.FixedSizeListArray.from_arrays(pa.array(state.ravel()), state.shape[1])
