import json
import math
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import CompressionMode

from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.importing.bags import is_bag, read_bag
from palpate.store.records import Recording
from palpate.store.store import Store
from tests.store.importing.bags.made import (
    START_NS,
    Written,
    joints,
    make,
    ns,
    number,
    text,
    topic_map,
    write_bag,
    write_json,
    write_mcap,
)

MAP = """
[topics."/joint_states".series.arm]
torque = {field = "effort[b]", unit = "N*m"}
[topics."/joint_states".series.gripper]
both = {field = "effort", quantity = "torque", unit = "N*m"}
[topics."/stiffness"]
result = {property = "elasticity", unit = "kPa", sd = 10}
"""
MESSAGES: list[Written] = [
    *(("/joint_states", ns(i / 100), joints(ns(i / 100) - 1000, ["a", "b"], [i, i / 3])) for i in range(60)),
    ("/stiffness", ns(0.7), number(42.0)),
    ("/other", ns(0.8), text("x")),
]


def channels_of(recording: Recording) -> dict[str, Any]:
    return {channel.name: channel for series in recording.series for channel in series.channels}


def test_every_storage_gives_the_same_recording(tmp_path: Path) -> None:
    """SQLite or MCAP, compressed or not, folder or single file: one digest, and one id that it gives."""
    topics = topic_map(tmp_path, MAP)
    paths = [
        write_bag(tmp_path / "a", MESSAGES),
        write_bag(tmp_path / "b", MESSAGES, version=8),
        write_bag(tmp_path / "c", MESSAGES, compression=CompressionMode.FILE),
        write_bag(tmp_path / "d", MESSAGES, compression=CompressionMode.MESSAGE),
        write_bag(tmp_path / "e", MESSAGES, "mcap"),
        write_bag(tmp_path / "f", MESSAGES, "mcap", CompressionMode.STORAGE),
        write_bag(tmp_path / "g", MESSAGES, "mcap", CompressionMode.FILE),
        write_bag(tmp_path / "h", MESSAGES, "mcap", CompressionMode.MESSAGE),
        write_mcap(tmp_path / "i.mcap", MESSAGES),
        write_mcap(tmp_path / "j.mcap", MESSAGES, "LZ4"),
        write_mcap(tmp_path / "k.mcap", MESSAGES, "NONE"),
        tmp_path / "a" / "a.db3",
        tmp_path / "e" / "e.mcap",
    ]
    found = [read_bag(path, topics) for path in paths]
    assert {len(recordings) for recordings in found} == {1}
    assert len({(recording.digest, recording.id) for (recording,) in found}) == 1
    assert all(map(is_bag, paths))


def test_messages_become_what_the_map_says(tmp_path: Path) -> None:
    """Object, action, series, results and the time of the first message are where they belong."""
    topics = topic_map(tmp_path, MAP)
    (found,) = read_bag(write_bag(tmp_path / "bag", MESSAGES), topics)
    channels = channels_of(found)
    assert (found.action, found.thing.dataset, found.thing.id) == ("squeezing", "ycb", "025_mug")
    assert found.recorded_at.isoformat() == "2024-05-01T12:30:15.250000+00:00"
    assert [series.name for series in found.series] == ["arm", "gripper"]
    assert channels["torque"].values.tolist() == [i / 3 for i in range(60)]
    assert channels["both"].values.tolist() == [[i, i / 3] for i in range(60)]
    # the header is a microsecond behind, and the recording begins 123 ns before the first message
    assert channels["torque"].time_s.tolist() == [(round(i * 1e7) - 1000 + 123) / 1e9 for i in range(60)]
    assert found.entries == (Value("elasticity", 42.0, 10.0, "kPa"),)
    assert found.notices == ("the map does not name /other: what the bag holds there is not imported",)


stamps = st.lists(st.integers(-(10**12), 10**12), min_size=1, max_size=30)


@given(stamps, st.data(), st.sampled_from(["sqlite3", "mcap"]))
@settings(max_examples=20)
def test_values_come_out_exactly(stamps: list[int], data: st.DataObject, storage: str) -> None:
    """Any numbers, NaN and infinity too, come out of a bag as they were, each at its time in seconds."""
    count = len(stamps)
    values = data.draw(st.lists(st.floats(), min_size=count, max_size=count))
    messages = [
        ("/j", START_NS + place, joints(START_NS + at, ["a", "b"], [0.0, value]))
        for place, (at, value) in enumerate(zip(stamps, values, strict=True))
    ]
    with TemporaryDirectory() as name:
        topics = topic_map(Path(name), '[topics."/j".series.s]\nx = {field = "effort[b]"}')
        (found,) = read_bag(write_bag(Path(name) / "bag", messages, storage), topics)
    channel = channels_of(found)["x"]
    assert channel.values.tobytes() == np.array(values).tobytes()
    assert channel.time_s.tolist() == [(at + 123) / 1e9 for at in stamps]


KINDS = {
    "Int8": st.integers(-(2**7), 2**7 - 1),
    "UInt8": st.integers(0, 2**8 - 1),
    "Int64": st.integers(-(2**63), 2**63 - 1),
    "UInt64": st.integers(0, 2**64 - 1),
    "Float32": st.floats(width=32),
    "Bool": st.booleans(),
}


@pytest.mark.parametrize("kind", KINDS)
@given(st.data())
@settings(max_examples=15)
def test_numbers_of_any_type_come_out_exactly(kind: str, data: st.DataObject) -> None:
    """Integers of 64 bits do not pass through floating point."""
    values = data.draw(st.lists(KINDS[kind], min_size=1, max_size=8))
    messages = [("/n", ns(place), make(f"std_msgs/msg/{kind}", data=value)) for place, value in enumerate(values)]
    with TemporaryDirectory() as name:
        topics = topic_map(Path(name), '[topics."/n".series.s]\nx = {field = "data"}')
        (found,) = read_bag(write_mcap(Path(name) / "bag.mcap", messages), topics)
    got = channels_of(found)["x"].values.tolist()
    assert all(one == other or (math.isnan(one) and math.isnan(other)) for one, other in zip(got, values, strict=True))


def test_large_and_small_unsigned_integers_stay_integers(tmp_path: Path) -> None:
    """Unsigned integers are exact where most of them need no 64th bit and one does."""
    values = [*range(5000), 2**64 - 1]
    messages = [("/n", ns(place / 1e6), make("std_msgs/msg/UInt64", data=value)) for place, value in enumerate(values)]
    topics = topic_map(tmp_path, '[topics."/n".series.s]\nx = {field = "data"}')
    (found,) = read_bag(write_mcap(tmp_path / "bag.mcap", messages), topics)
    assert channels_of(found)["x"].values.tolist() == values


def test_json_is_read(tmp_path: Path) -> None:
    """Messages in JSON become the same: fields by name, stamps from their header, NaN as NaN."""
    messages = [
        ("/j", ns(i), {"timestamp": {"sec": 1_714_566_616 + i, "nsec": 0}, "name": ["x"], "effort": [value]})
        for i, value in enumerate([1, 2.5, math.nan])
    ]
    topics = topic_map(tmp_path, '[topics."/j".series.s]\nx = {field = "effort[x]", unit = "N*m"}')
    (found,) = read_bag(write_json(tmp_path / "bag.mcap", messages), topics)
    channel = channels_of(found)["x"]
    assert channel.values[:2].tolist() == [1.0, 2.5]
    assert np.isnan(channel.values[2])
    assert channel.time_s.tolist() == [0.75, 1.75, 2.75]


@given(st.binary(max_size=30) | st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=3),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(["data", "header", "name"]), inner),
    max_leaves=6,
))  # fmt: skip
@settings(max_examples=100)
def test_json_that_is_something_else_is_one_sentence(content: Any) -> None:
    """Whatever a message holds, it is a StoreError that names the bag, or a recording."""
    uses = ['series.s.x = {field = "data[0]"}', "files = 'f'", "sound = 's.wav'", "pose = 'object_pose'", "log = true"]
    uses += ['result = {property = "p"}']
    data = content if isinstance(content, bytes) else json.dumps(content).encode()
    with TemporaryDirectory() as name:
        bag = write_json(Path(name) / "bag.mcap", [("/j", ns(0), data)])
        for use in uses:
            try:
                found = read_bag(bag, topic_map(Path(name), f'[topics."/j"]\n{use}'))
            except StoreError as error:
                assert str(error).startswith(str(bag))  # noqa: PT017
            else:
                assert len(found) == 1


def test_other_encodings_are_named(tmp_path: Path) -> None:
    """A topic in protobuf is refused by the name of its encoding where the map wants it, and no matter else."""
    bag = write_json(tmp_path / "bag.mcap", [("/p", ns(0), b"\1\2")], "protobuf")
    with pytest.raises(StoreError, match=r"/p: its messages are encoded as 'protobuf', which is not supported; exp"):
        read_bag(bag, topic_map(tmp_path, '[topics."/p"]\nlog = true'))
    with pytest.raises(StoreError, match="no message of a topic of the map; it has /p"):
        read_bag(bag, topic_map(tmp_path, '[topics."/q"]\nlog = true'))


def test_topics_that_are_not_there_are_told(tmp_path: Path) -> None:
    """A topic of the map that the bag has not is a notice, or an error where it is required."""
    bag = write_bag(tmp_path / "bag", MESSAGES)
    (found,) = read_bag(bag, topic_map(tmp_path, MAP + '[topics."/scale"]\nlog = true'))
    assert "there is no message of /scale, which the map names" in found.notices
    with pytest.raises(StoreError, match=r"no message of /stifness, which the map requires \(did you mean '/stiffness"):
        read_bag(bag, topic_map(tmp_path, MAP + '[topics."/stifness"]\nrequired = true\nlog = true'))


def test_fields_that_are_not_there_are_told(tmp_path: Path) -> None:
    """A channel that no message holds is an error; one that some hold has these, with a notice."""
    messages: list[Written] = [
        ("/j", ns(i), joints(ns(i), *((["a"], [i]) if i % 2 else (["b", "c"], [i, 0])))) for i in range(6)
    ]
    bag = write_bag(tmp_path / "bag", messages)
    (found,) = read_bag(bag, topic_map(tmp_path, '[topics."/j".series.s]\nx = {field = "effort[a]"}'))
    channel = channels_of(found)["x"]
    assert channel.values.tolist() == [1, 3, 5]
    assert channel.time_s.tolist() == [1.000000123, 3.000000123, 5.000000123]
    assert "/j: 3 of 6 messages hold no effort[a]: the channel has the others" in found.notices
    with pytest.raises(StoreError, match=r"bag: /j effort\[d\]: nothing in 'effort' is named 'd'; choose from"):
        read_bag(bag, topic_map(tmp_path, '[topics."/j".series.s]\nx = {field = "effort[d]"}'))
    with pytest.raises(StoreError, match=r"/j effort: not as many numbers in each message"):
        read_bag(bag, topic_map(tmp_path, '[topics."/j".series.s]\nx = {field = "effort"}'))
    with pytest.raises(StoreError, match=r"/j header.frame_id: found 'base', expected numbers"):
        read_bag(bag, topic_map(tmp_path, '[topics."/j".series.s]\nx = {field = "header.frame_id"}'))


def test_messages_in_disorder_are_put_in_order(tmp_path: Path) -> None:
    """Samples are in the order in which messages were written, wherever they stand in the file."""
    order = [3, 1, 0, 2]
    messages: list[Written] = [("/n", ns(i), number(i)) for i in order]
    topics = topic_map(tmp_path, '[topics."/n".series.s]\nx = {field = "data"}')
    for bag in (write_mcap(tmp_path / "bag.mcap", messages), write_bag(tmp_path / "bag", messages)):
        (found,) = read_bag(bag, topics)
        assert channels_of(found)["x"].values.tolist() == [0, 1, 2, 3]


def test_split_bags_are_one(tmp_path: Path) -> None:
    """A bag of several files is read as one, and a file that lacks messages is noticed."""
    halves = [write_bag(tmp_path / name, part) for name, part in (("one", MESSAGES[:30]), ("two", MESSAGES[30:]))]
    both = tmp_path / "both"
    both.mkdir()
    for half in halves:
        (both / f"{half.name}.db3").write_bytes((half / f"{half.name}.db3").read_bytes())
    metadata = (halves[0] / "metadata.yaml").read_text()
    (both / "metadata.yaml").write_text(metadata.replace("- one.db3", "- one.db3\n  - two.db3"))
    topics = topic_map(tmp_path, MAP)
    (whole,) = read_bag(write_bag(tmp_path / "whole", MESSAGES), topics)
    (found,) = read_bag(both, topics)
    assert found.series == whole.series
    assert "/joint_states: the bag's metadata speak of 30 messages, and it holds 60" in found.notices


def test_the_store_takes_it_once(tmp_path: Path, local: Store) -> None:
    """An import can be repeated: the second time the recording is there."""
    topics = topic_map(tmp_path, MAP)
    bag = write_bag(tmp_path / "bag", MESSAGES)
    receipts = [local.put(recording) for _ in range(2) for recording in read_bag(bag, topics)]
    assert [receipt.new for receipt in receipts] == [True, False]
    (recording,) = read_bag(bag, topics)
    assert local.get(receipts[0].id) == recording


def test_a_clock_of_its_own_is_kept_and_told(tmp_path: Path) -> None:
    """Stamps of a clock that is not the log's are kept; `clock = "log"` takes the log's, and unset ones do too."""
    messages: list[Written] = [("/j", ns(i), joints(10**9 * i, ["a"], [i])) for i in range(3)]
    bag = write_bag(tmp_path / "bag", messages)
    text = '[topics."/j"]\n{}series.s.x.field = "effort[a]"'
    (by_header,) = read_bag(bag, topic_map(tmp_path, text.format("")))
    (by_log,) = read_bag(bag, topic_map(tmp_path, text.format('clock = "log"\n')))
    assert channels_of(by_log)["x"].time_s.tolist() == [1.23e-7, 1.000000123, 2.000000123]
    assert by_log.notices == ()
    first, *others = channels_of(by_header)["x"].time_s.tolist()
    assert first == 1.23e-7
    assert others == [(i * 10**9 - 1714566615250000000) / 1e9 for i in (1, 2)]
    assert "/j: 1 of 3 messages have no time stamp: when they were written is taken" in by_header.notices
    assert any("they are of another clock and are kept" in notice for notice in by_header.notices)


def test_simulated_time_is_told(tmp_path: Path) -> None:
    """A bag whose clock begins at zero is kept, with a notice."""
    messages = [("/n", i, number(i)) for i in range(3)]
    topics = topic_map(tmp_path, '[topics."/n".series.s]\nx = {field = "data"}')
    (found,) = read_bag(write_bag(tmp_path / "bag", messages), topics)
    assert found.notices[0].startswith("the bag's clock begins at 1970-01-01 00:00:00")


def test_what_a_store_refuses_is_refused_with_the_bag(tmp_path: Path) -> None:
    """A recording that cannot be kept is refused by the field, and by the name of the bag."""
    bag = write_bag(tmp_path / "bag", [("/n", ns(2e9), number(1.0))])
    with pytest.raises(StoreError, match=r"bag: recorded_at: .* is in the future"):
        read_bag(bag, topic_map(tmp_path, '[topics."/n".series.s]\nx = {field = "data"}'))
