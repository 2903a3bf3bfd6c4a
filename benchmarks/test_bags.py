"""Bags of 100,000 messages of seven joints, read into fourteen channels: messages a second is 100,000 by the time."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from palpate.store.importing.bags import read_bag, read_topic_map

Fixture = Any  # pytest-benchmark's fixture
MANY = 100_000
JOINTS = [f"joint_{number}" for number in range(1, 8)]
BEGIN_S = 1_714_566_615
HEAD = 'action = "squeezing"\nobject = {dataset = "made up", id = "mug"}\n[topics."/joint_states".series.arm]\n'


@pytest.fixture(scope="module", params=list(StoragePlugin), ids=lambda plugin: plugin.name.lower())
def bag(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bag of each storage, with the map beside it."""
    types = get_typestore(Stores.ROS2_HUMBLE)
    path = tmp_path_factory.mktemp("bags") / "bag"
    values = np.random.default_rng(0).normal(size=(3, 7))
    made = types.types
    with Writer(path, version=9, storage_plugin=request.param) as writer:
        topic = writer.add_connection("/joint_states", "sensor_msgs/msg/JointState", typestore=types)
        for number in range(MANY):
            stamp = made["builtin_interfaces/msg/Time"](BEGIN_S + number // 1000, number % 1000 * 1_000_000)
            header = made["std_msgs/msg/Header"](stamp, "base")
            message = made["sensor_msgs/msg/JointState"](header, JOINTS, *values)
            at_ns = BEGIN_S * 10**9 + number * 1_000_000
            writer.write(topic, at_ns, types.serialize_cdr(message, "sensor_msgs/msg/JointState"))
    channels = [
        f'{field}_{name} = {{field = "{field}[{name}]"}}' for field in ("effort", "position") for name in JOINTS
    ]
    (path.parent / "topics.toml").write_text(HEAD + "\n".join(channels))
    return path


def test_read_a_bag(bag: Path, benchmark: Fixture) -> None:
    topics = read_topic_map(bag.parent / "topics.toml")
    (found,) = benchmark.pedantic(read_bag, (bag, topics), rounds=2, iterations=1)
    assert [len(channel.values) for channel in found.series[0].channels] == [MANY] * 14
