"""The tables of an export: their columns, each with its kind and what it says."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import pyarrow as pa

from palpate.store.exporting.kinds import (
    AUDIO,
    BYTES,
    IMAGE,
    MOMENT,
    NUMBER,
    NUMBERS,
    TEXT,
    TEXTS,
    TRUTH,
    WHOLE,
    WHOLES,
    Kind,
)

__all__ = [
    "AUDIOS",
    "CHANNELS",
    "ENTRIES",
    "FILES",
    "IMAGES",
    "OBJECTS",
    "RECORDINGS",
    "SETUPS",
    "TABLES",
    "Column",
    "Table",
]


@dataclass(frozen=True)
class Column:
    """A column: its name with its unit, its kind, and what it says."""

    name: str
    kind: Kind
    words: str


@dataclass(frozen=True)
class Table:
    """A table: its name, what one row is, and its columns."""

    name: str
    words: str
    columns: tuple[Column, ...]

    @property
    def schema(self) -> pa.Schema:
        """Its columns in Parquet; images and sounds are marked, so that Hugging Face ``datasets`` decodes them."""
        hub = {column.name: {"_type": column.kind.hub} for column in self.columns if column.kind.hub is not None}
        marks = {"huggingface": json.dumps({"info": {"features": hub}})} if hub else None
        return pa.schema([(column.name, column.kind.arrow) for column in self.columns], marks)

    def of(self, rows: Sequence[dict[str, Any]]) -> pa.Table:
        """Rows as Arrow; what a row does not name is null."""
        return pa.Table.from_pylist(list(rows), self.schema)


RECORDING = Column("recording", TEXT, "id of the recording")
ACTION = Column("action", TEXT, "what the robot did")
DATASET = Column("dataset", TEXT, "dataset of the object")
OBJECT = Column("object", TEXT, "name of the object in its dataset")
GRIPPER = Column("gripper", TEXT, "name of the gripper")
RECORDED_AT = Column("recorded_at", MOMENT, "when it was recorded")
GROUND_TRUTH = Column("ground_truth", TRUTH, "whether the results are known to be true")
NAME = Column("name", TEXT, "name of the file in the recording")
MEDIA_TYPE = Column("media_type", TEXT, "media type of the file")
SHA256 = Column("sha256", TEXT, "SHA-256 of the file")

RECORDINGS = Table(
    "recordings",
    "a measurement",
    (
        RECORDING,
        Column("digest", TEXT, "SHA-256 of all that was recorded"),
        RECORDED_AT,
        ACTION,
        DATASET,
        OBJECT,
        Column("common_name", TEXT, "what the object is called"),
        Column("setup", TEXT, "digest of the setup, as in the table setups"),
        GRIPPER,
        Column("owner", TEXT, "whose the recording is"),
        Column("licence", TEXT, "licence as stated when it was recorded"),
        Column("visibility", TEXT, "private, lab or public"),
        GROUND_TRUTH,
        Column("software", TEXT, "version of the program that measured"),
        Column("repository", TEXT, "where that program is"),
        Column("grasp_json", TEXT, "how the object was held"),
        Column("gripper_position_m", NUMBERS, "x, y, z of the gripper [m]"),
        Column("gripper_quaternion", NUMBERS, "w, x, y, z of the gripper's rotation; null where it cannot be told"),
        Column("gripper_frame", TEXT, "frame of reference of the gripper's pose"),
        Column("gripper_pose_json", TEXT, "the gripper's pose as it was given"),
        Column("object_position_m", NUMBERS, "x, y, z of the object [m]"),
        Column("object_quaternion", NUMBERS, "w, x, y, z of the object's rotation; null where it cannot be told"),
        Column("object_frame", TEXT, "frame of reference of the object's pose"),
        Column("object_pose_json", TEXT, "the object's pose as it was given"),
        Column("log", TEXT, "what the program printed"),
        Column("notices", TEXTS, "what was odd"),
    ),
)
ENTRIES = Table(
    "entries",
    "a result of a measurement",
    (
        RECORDING,
        Column("position", WHOLE, "its place among the results of the recording, from 0"),
        RECORDED_AT,
        ACTION,
        DATASET,
        OBJECT,
        GRIPPER,
        GROUND_TRUTH,
        Column("kind", TEXT, "value, distribution, interval, bound or failed"),
        Column("property", TEXT, "the property it is about"),
        Column("value", NUMBER, "of a value, in its unit"),
        Column("sd", NUMBER, "standard deviation of the value, in its unit"),
        Column("low", NUMBER, "lower end of an interval or a bound, in its unit"),
        Column("high", NUMBER, "upper end of an interval or a bound, in its unit"),
        Column("unit", TEXT, "as it was given; null where nobody stated it"),
        Column("value_si", NUMBER, "the value in SI base units"),
        Column("sd_si", NUMBER, "its standard deviation in SI base units"),
        Column("label", TEXT, "most probable label of a distribution"),
        Column("labels", TEXTS, "labels of a distribution"),
        Column("probabilities", NUMBERS, "their probabilities, in the same order"),
        Column("reason", TEXT, "why there is no result"),
    ),
)
CHANNELS = Table(
    "channels",
    "a channel of a series: samples of one quantity",
    (
        RECORDING,
        Column("series", TEXT, "name of the series, often of its device"),
        Column("channel", TEXT, "name of the channel"),
        Column("quantity", TEXT, "what was measured"),
        Column("unit", TEXT, "unit of the values; null where nobody stated it"),
        Column("rate_hz", NUMBER, "samples per second [Hz], where they are evenly spaced"),
        Column("time_s", NUMBERS, "time stamps [s], where they are not"),
        Column("values", NUMBERS, "the samples in their unit, as numbers of 64 bits; row by row where one is an array"),
        Column("sample_shape", WHOLES, "shape of one sample; empty for single numbers"),
        Column("dtype", TEXT, "type of number as it was recorded"),
    ),
)
OBJECTS = Table(
    "objects",
    "an object",
    (
        DATASET,
        OBJECT,
        Column("maker", TEXT, "who makes it"),
        Column("common_name", TEXT, "what it is called"),
        Column("aliases", TEXTS, "other names"),
        Column("attributes_json", TEXT, "what else is known of it"),
        Column("same_as_dataset", TEXT, "dataset of the object that it was found to be the same as"),
        Column("same_as_object", TEXT, "name of that object"),
    ),
)
SETUPS = Table(
    "setups",
    "a device of a setup; a setup of which nothing is known has no rows",
    (
        Column("setup", TEXT, "digest of the setup"),
        Column("kind", TEXT, "arm, gripper, camera, microphone or other"),
        Column("device", TEXT, "what it is"),
        Column("maker", TEXT, "who makes it"),
        Column("calibrated_on", TEXT, "when it was calibrated, as a date"),
        Column("parameters_json", TEXT, "its parameters"),
        Column("calibration_json", TEXT, "its calibration"),
    ),
)
IMAGES = Table(
    "images", "an image", (RECORDING, NAME, MEDIA_TYPE, SHA256, Column("image", IMAGE, "the file, as it was recorded"))
)
AUDIOS = Table(
    "audio", "a sound", (RECORDING, NAME, MEDIA_TYPE, SHA256, Column("audio", AUDIO, "the file, as it was recorded"))
)
FILES = Table(
    "files",
    "a file that is neither image nor sound",
    (RECORDING, NAME, MEDIA_TYPE, SHA256, Column("data", BYTES, "the file, as it was recorded")),
)
TABLES = (RECORDINGS, ENTRIES, CHANNELS, OBJECTS, SETUPS, IMAGES, AUDIOS, FILES)
