import sqlite3
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer as McapWriter

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.importing.bags.definitions import Decoders
from palpate.store.importing.bags.packets import Kind
from tests.store.importing.bags.made import HEAD, header, joints, make, ns, topic_map, types, write_bag

JOINTS = '[topics."/j".series.s]\nx = {field = "effort[a]"}\n'


def undefined(folder: Path, topic: str, message: Any) -> Path:
    """A bag as older releases write it: without the definitions of its types."""
    bag = write_bag(folder, [(topic, ns(0), message)])
    with closing(sqlite3.connect(bag / f"{bag.name}.db3")) as connection, connection:
        connection.execute("DROP TABLE message_definitions")
    return bag


def test_a_bag_without_definitions_uses_those_of_a_release(tmp_path: Path) -> None:
    """Types of ROS 2 are known without the bag's help; which release they are of is told, or the map says."""
    bag = undefined(tmp_path / "bag", "/j", joints(ns(0), ["a"], [1.5]))
    (found,) = read_bag(bag, topic_map(tmp_path, JOINTS))
    assert found.series[0].channels[0].values.tolist() == [1.5]
    assert found.notices == ("the bag does not define all its types: those of a recent ROS 2 are assumed",)
    (stated,) = read_bag(bag, topic_map(tmp_path, JOINTS, 'distribution = "humble"' + HEAD))
    assert stated.notices == ()
    with pytest.raises(StoreError, match=r"distribution 'humbel' \(did you mean 'humble'\?\) is unknown"):
        read_bag(bag, topic_map(tmp_path, JOINTS, 'distribution = "humbel"' + HEAD))


def test_the_metadata_name_the_release(tmp_path: Path) -> None:
    """A bag that names its release needs no other."""
    bag = undefined(tmp_path / "bag", "/j", joints(ns(0), ["a"], [1.5]))
    metadata = bag / "metadata.yaml"
    metadata.write_text(metadata.read_text().replace("ros_distro: rosbags", "ros_distro: jazzy"))
    (found,) = read_bag(bag, topic_map(tmp_path, JOINTS))
    assert found.notices == ()


def test_the_map_can_define_types(tmp_path: Path) -> None:
    """A type that neither bag nor release define stands in the map, and may use others there and in the release."""
    audio = make("audio_common_msgs/msg/AudioData", data=np.array([1, 2], np.uint8))
    message = make("audio_common_msgs/msg/AudioDataStamped", header=header(ns(0)), audio=audio)
    bag = undefined(tmp_path / "bag", "/a", message)
    text = '[topics."/a"]\nsound = "s.mp3"\n'
    with pytest.raises(StoreError, match="/a: the bag does not define the type 'audio_common_msgs/msg/AudioDataSta"):
        read_bag(bag, topic_map(tmp_path, text))
    stamped = '"audio_common_msgs/msg/AudioDataStamped" = """\nstd_msgs/Header header\nAudioData audio\n"""\n'
    given = f'[definitions]\n{stamped}"audio_common_msgs/AudioData" = "uint8[] data"'
    (found,) = read_bag(bag, topic_map(tmp_path, text + given))
    assert found.files[0].data == b"\1\2"


IDL = """module a_msgs {
  module msg {
    struct Thing {
      double force;
      sequence<long> counts;
    };
  };
};
"""


def test_definitions_in_idl_are_read(tmp_path: Path) -> None:
    """A schema in IDL defines a type as one in .msg does."""
    message = b"\0\1\0\0" + b"\0\0\0\0\0\0\x04\x40" + b"\2\0\0\0" + b"\7\0\0\0" + b"\x08\0\0\0"
    with (tmp_path / "bag.mcap").open("wb") as file:
        writer = McapWriter(file)
        writer.start("ros2")
        schema = writer.register_schema("a_msgs/msg/Thing", "ros2idl", IDL.encode())
        writer.add_message(writer.register_channel("/t", "cdr", schema), ns(0), message, ns(0))
        writer.finish()
    topics = topic_map(tmp_path, '[topics."/t".series.s]\nforce = {field = "force"}\ncount = {field = "counts[1]"}')
    (found,) = read_bag(tmp_path / "bag.mcap", topics)
    assert [channel.values.tolist() for channel in found.series[0].channels] == [[2.5], [8]]


@pytest.mark.parametrize(
    ("type", "language", "definition"),
    [
        ("a/msg/B", "ros2msg", "float64 x\n???"),
        ("a/msg/B", "ros2msg", "float64 x\nUnknown y"),
        ("a/msg/B:\n  x = __import__('os')\nclass C", "ros2msg", "float64 x"),
        ("1a/msg/2B", "ros2msg", "float64 x"),
        ("a/msg/B", "ros2msg", "C[1000000000] c\n" + "=" * 80 + "\nMSG: a/C\nuint8 x"),
        ("a/msg/B", "ros2msg", "string[1000000000] c"),
        ("a/msg/B", "ros2msg", "B b"),
        ("a/msg/B", "ros2msg", "uint8 x\n" * 200_000),
        ("a/msg/B", "ros2idl", "module a { struct"),
        ("a/msg/B", "ros2idl", IDL),
        ("a/msg/B", "protobuf", "x"),
    ],
)
def test_definitions_that_are_none_are_refused(type: str, language: str, definition: str) -> None:
    """What is no definition, or would become endless or foreign code, is one sentence with the topic."""
    with pytest.raises(StoreError, match=r"^/t: "):
        Decoders({}, None).decoder(Kind("/t", type, "cdr", language, definition))


def test_one_type_may_be_defined_in_two_ways() -> None:
    """Bags that were put together from several may define a type differently for each topic."""
    decoders = Decoders({}, None)
    small = decoders.decoder(Kind("/a", "a/msg/B", "cdr", "ros2msg", "uint8 x"))(b"\0\1\0\0\5")
    large = decoders.decoder(Kind("/b", "a/msg/B", "cdr", "ros2msg", "uint16 y"))(b"\0\1\0\0\5\1")
    assert (small.x, large.y) == (5, 261)
    assert "a/msg/B" not in types.fielddefs
