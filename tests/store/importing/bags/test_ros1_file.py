from pathlib import Path
from typing import Any

import pytest
from rosbags.rosbag1 import Writer
from rosbags.typesys import Stores, get_typestore

from palpate.store.errors import StoreError
from palpate.store.importing.bags import is_bag, read_bag
from palpate.store.importing.bags import ros1_file as module
from tests.store.importing.bags.made import ns, topic_map

MAP = '[topics."/n".series.s]\nx = {field = "data"}'


def write(path: Path, compression: str | None) -> Path:
    store = get_typestore(Stores.ROS1_NOETIC)
    writer = Writer(path)
    if compression:
        writer.set_compression(Writer.CompressionFormat[compression])
    with writer:
        connection = writer.add_connection("/n", "std_msgs/msg/Float64", typestore=store)
        for place in range(5):
            message: Any = store.types["std_msgs/msg/Float64"](place / 2)
            writer.write(connection, ns(place), store.serialize_ros1(message, "std_msgs/msg/Float64"))
    return path


@pytest.mark.parametrize("compression", [None, "BZ2", "LZ4"])
def test_bags_of_ros_1_are_read(tmp_path: Path, compression: str | None) -> None:
    """A .bag of ROS 1 becomes the same as one of ROS 2."""
    bag = write(tmp_path / "old.bag", compression)
    (found,) = read_bag(bag, topic_map(tmp_path, MAP))
    (channel,) = found.series[0].channels
    assert is_bag(bag)
    assert channel.values.tolist() == [0, 0.5, 1, 1.5, 2]
    assert channel.time_s is not None
    assert channel.time_s.tolist() == [(place * 10**9 + 123) / 1e9 for place in range(5)]


@pytest.mark.parametrize("compression", ["BZ2", "LZ4"])
def test_what_unpacks_to_too_much_is_refused(tmp_path: Path, compression: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A chunk has a limit when it is unpacked, whichever way it was packed."""
    name = f"un{compression.lower()}"
    limited = getattr(module, name)
    monkeypatch.setattr(module, name, lambda data, where: limited(data, where, 50))
    with pytest.raises(StoreError, match="more than 50 bytes when it is unpacked"):
        read_bag(write(tmp_path / "old.bag", compression), topic_map(tmp_path, MAP))


def test_a_bag_that_was_cut_is_refused(tmp_path: Path) -> None:
    """A .bag without its index is one sentence that says what mends it."""
    bag = write(tmp_path / "old.bag", None)
    bag.write_bytes(bag.read_bytes()[:-150])
    with pytest.raises(StoreError, match="rosbag reindex"):
        read_bag(bag, topic_map(tmp_path, MAP))
