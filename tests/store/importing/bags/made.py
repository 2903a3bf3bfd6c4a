"""Bags with known content, made by the writers of other libraries."""

import json
from collections.abc import Iterable, Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

from palpate.store.importing.bags import TopicMap, read_topic_map

START_NS = 1_714_566_615_250_000_123
"""1 May 2024, 12:30:15 UTC and a little."""

HEAD = """
action = "squeezing"
[object]
dataset = "ycb"
id = "025_mug"
"""

types = get_typestore(Stores.ROS2_HUMBLE)
types.register(get_types_from_msg("uint8[] data", "audio_common_msgs/msg/AudioData"))
types.register(
    get_types_from_msg(
        "std_msgs/Header header\naudio_common_msgs/AudioData audio", "audio_common_msgs/msg/AudioDataStamped"
    )
)
types.register(get_types_from_msg("int32 format\nint32 channels\nint32 rate\nint32 chunk", "sound_msgs/msg/AudioInfo"))
types.register(
    get_types_from_msg(
        "float32[] float32_data\nint32[] int32_data\nint32[] int24_data\n"
        "int16[] int16_data\nint8[] int8_data\nuint8[] uint8_data",
        "sound_msgs/msg/AudioData",
    )
)
types.register(get_types_from_msg("sound_msgs/AudioData audio\nsound_msgs/AudioInfo info", "sound_msgs/msg/Audio"))
types.register(get_types_from_msg("std_msgs/Header header\nsound_msgs/Audio audio", "sound_msgs/msg/AudioStamped"))

Written = tuple[str, int, Any]
"""Topic, when it was written [ns], message."""


def ns(seconds: float) -> int:
    """A moment so many seconds after the start."""
    return START_NS + round(seconds * 1e9)


def stamp(moment_ns: int) -> Any:
    return types.types["builtin_interfaces/msg/Time"](*divmod(moment_ns, 1_000_000_000))


def header(moment_ns: int, frame: str = "base") -> Any:
    return types.types["std_msgs/msg/Header"](stamp(moment_ns), frame)


def make(type: str, **fields: Any) -> Any:
    """A message of a type."""
    return types.types[type](**fields)


def joints(moment_ns: int, names: list[str], effort: Iterable[float], position: Iterable[float] = ()) -> Any:
    arrays = {"position": position, "velocity": (), "effort": effort}
    return make(
        "sensor_msgs/msg/JointState",
        header=header(moment_ns),
        name=names,
        **{key: np.array(list(values), np.float64) for key, values in arrays.items()},
    )


def number(value: float) -> Any:
    return make("std_msgs/msg/Float64", data=value)


def text(value: str) -> Any:
    return make("std_msgs/msg/String", data=value)


def write_bag(
    folder: Path,
    messages: Iterable[Written],
    storage: str = "sqlite3",
    compression: CompressionMode = CompressionMode.NONE,
    version: Any = 9,
) -> Path:
    """Write the folder of a ROS 2 bag."""
    writer = Writer(folder, version=version, storage_plugin=StoragePlugin[storage.upper()])
    writer.set_compression(compression, CompressionFormat.ZSTD)
    with writer:
        connections: dict[str, Any] = {}
        for topic, log_ns, message in messages:
            if topic not in connections:
                connections[topic] = writer.add_connection(topic, message.__msgtype__, typestore=types)
            writer.write(connections[topic], log_ns, types.serialize_cdr(message, message.__msgtype__))
    return folder


def write_mcap(
    path: Path, messages: Iterable[Written], compression: str = "ZSTD", *, chunk_size: int = 1024, end: bool = True
) -> Path:
    """Write an MCAP file with messages of ROS 2 in CDR, by mcap's own writer."""
    file = BytesIO()
    writer = McapWriter(file, chunk_size, CompressionType[compression])
    writer.start("ros2", "made up")
    channels: dict[str, int] = {}
    for topic, log_ns, message in messages:
        name = message.__msgtype__
        if topic not in channels:
            definition = types.generate_msgdef(name, ros_version=2)[0].encode()
            schema = writer.register_schema(name, "ros2msg", definition)
            channels[topic] = writer.register_channel(topic, "cdr", schema)
        writer.add_message(channels[topic], log_ns, bytes(types.serialize_cdr(message, name)), log_ns)
    if end:
        writer.finish()
    path.write_bytes(file.getvalue())
    return path


def write_json(path: Path, messages: Iterable[tuple[str, int, Any]], encoding: str = "json") -> Path:
    """Write an MCAP file with messages in JSON."""
    with path.open("wb") as file:
        writer = McapWriter(file)
        writer.start("", "made up")
        schema = writer.register_schema("thing", "jsonschema", b'{"type": "object"}')
        channels: dict[str, int] = {}
        for topic, log_ns, message in messages:
            if topic not in channels:
                channels[topic] = writer.register_channel(topic, encoding, schema)
            data = message if isinstance(message, bytes) else json.dumps(message).encode()
            writer.add_message(channels[topic], log_ns, data, log_ns)
        writer.finish()
    return path


def topic_map(folder: Path, text: str, head: str = HEAD) -> TopicMap:
    """The map that a text stands for; what is about the whole of it comes with it."""
    file = folder / "topics.toml"
    file.write_text(head + text, encoding="utf-8")
    return read_topic_map(file)


def values_of(series: Mapping[str, Any]) -> dict[str, list[Any]]:
    """Channel to its values, as lists."""
    return {name: channel.values.tolist() for name, channel in series.items()}
