from pathlib import Path
from typing import Any

import pytest

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.records import Recording
from tests.store.importing.bags.made import make, ns, number, text, topic_map, write_bag, write_json, write_mcap

NUMBERS: list[Any] = [("/n", ns(i), number(i)) for i in range(10)]
CHANNEL = '[topics."/n".series.s]\nx = {field = "data"}\n'


def values(recordings: tuple[Recording, ...]) -> list[list[float]]:
    return [recording.series[0].channels[0].values.tolist() for recording in recordings]


def test_times_cut_a_bag(tmp_path: Path) -> None:
    """Recordings by times hold what was written from their start to before their stop, with times of their own."""
    cuts = """
        [[recordings]]
        start_s = 1
        stop_s = 3
        [[recordings]]
        start_s = 7.5
        action = "weighing"
        object = {dataset = "lab", id = "sponge"}
    """
    found = read_bag(write_bag(tmp_path / "bag", NUMBERS), topic_map(tmp_path, CHANNEL + cuts))
    assert values(found) == [[1, 2], [8, 9]]
    assert [(one.action, one.thing.id) for one in found] == [("squeezing", "025_mug"), ("weighing", "sponge")]
    assert [one.recorded_at.timestamp() for one in found] == [1714566616.25, 1714566622.75]
    time_s = found[1].series[0].channels[0].time_s
    assert time_s is not None
    assert time_s.tolist() == [0.500000123, 1.500000123]
    assert len({one.id for one in found}) == 2


def test_a_cut_without_messages_is_refused(tmp_path: Path) -> None:
    """A recording in which nothing lies is refused with its time."""
    topics = topic_map(tmp_path, CHANNEL + "[[recordings]]\nstart_s = 20\nstop_s = 30")
    with pytest.raises(StoreError, match="up to 2024-05-01 12:30:45 there is no message of a topic of the map"):
        read_bag(write_bag(tmp_path / "bag", NUMBERS), topics)


@pytest.mark.parametrize(
    ("marks", "expected", "told"),
    [
        ([(1.5, "begin"), (3.5, "end"), (5.5, "begin"), (6.5, "end")], [[2, 3], [6]], ""),
        ([(1.5, "begin"), (3.5, "begin"), (4.5, "end")], [[2, 3], [4]], "ends where the next one starts"),
        ([(0.5, "end"), (7.5, "begin")], [[8, 9]], "ends with the bag"),
        ([(1.5, "begin"), (2.5, "what"), (3.5, "end"), (4.5, "end")], [[2, 3]], ""),
    ],
)
def test_markers_cut_a_bag(
    tmp_path: Path, marks: list[tuple[float, str]], expected: list[list[float]], told: str
) -> None:
    """Recordings lie between the messages of a topic; an end that is missing is told, other messages do not count."""
    messages = [*NUMBERS, *(("/trial", ns(at), text(mark)) for at, mark in marks)]
    topics = topic_map(tmp_path, CHANNEL + '[marker]\ntopic = "/trial"\nstart = "begin"\nstop = "end"')
    for bag in (write_bag(tmp_path / "bag", messages), write_mcap(tmp_path / "bag.mcap", messages)):
        found = read_bag(bag, topics)
        assert values(found) == expected
        assert [notice for one in found for notice in one.notices if "told no end" in notice and told in notice] == [
            notice for one in found for notice in one.notices
        ]
        assert bool(told) == any(one.notices for one in found)


def test_markers_can_be_booleans(tmp_path: Path) -> None:
    """A topic that is true while a recording goes on marks it."""
    marks = [("/on", ns(at), make("std_msgs/msg/Bool", data=on)) for at, on in ((2.5, True), (4.5, False))]
    topics = topic_map(tmp_path, CHANNEL + '[marker]\ntopic = "/on"\nstart = true\nstop = false')
    assert values(read_bag(write_bag(tmp_path / "bag", [*NUMBERS, *marks]), topics)) == [[3, 4]]


def test_a_marker_that_never_starts_is_refused(tmp_path: Path) -> None:
    """A bag in which no recording starts is refused with what a start would be; so is a marker of another kind."""
    topics = topic_map(tmp_path, CHANNEL + '[marker]\ntopic = "/trial"\nstart = "begin"\nstop = "end"')
    with pytest.raises(StoreError, match="/trial: no message holds 'begin'"):
        read_bag(write_bag(tmp_path / "bag", NUMBERS), topics)
    for data, told in (({"data": [1]}, "/trial data: found list"), ({}, "no field 'data'"), (b"{", "cannot be read")):
        bag = write_json(tmp_path / "bag.mcap", [("/trial", ns(0), data)])
        with pytest.raises(StoreError, match=told):
            read_bag(bag, topics)


HEAD = """
action = {topic = "/action", field = "data"}
[object]
dataset = "ycb"
id = {topic = "/object", field = "data"}
common_name = "thing"
"""


def test_the_bag_tells_object_and_action(tmp_path: Path) -> None:
    """What was told last before a recording began holds for it, else what is told first in it."""
    told = [("/object", ns(0), text("011_banana")), ("/object", ns(5), text("025_mug"))]
    told += [("/action", ns(2.5), text("squeezing"))]
    cuts = "[[recordings]]\nstart_s = 2\nstop_s = 4\n[[recordings]]\nstart_s = 6\n"
    found = read_bag(write_bag(tmp_path / "bag", [*NUMBERS, *told]), topic_map(tmp_path, CHANNEL + cuts, HEAD))
    assert [(one.action, one.thing.id, one.thing.common_name) for one in found] == [
        ("squeezing", "011_banana", "thing"),
        ("squeezing", "025_mug", "thing"),
    ]
    assert [one.notices for one in found] == [(), ()]


def test_a_bag_that_does_not_tell_is_refused(tmp_path: Path) -> None:
    """A recording whose object nobody told is refused, and so is one told by a number."""
    topics = topic_map(tmp_path, CHANNEL, HEAD)
    with pytest.raises(StoreError, match="/action: there is no message for the recording"):
        read_bag(write_bag(tmp_path / "bag", NUMBERS), topics)
    numbered = [*NUMBERS, ("/action", ns(0), make("std_msgs/msg/Int8", data=3)), ("/object", ns(0), text("x"))]
    with pytest.raises(StoreError, match="/action: found 3, expected text"):
        read_bag(write_bag(tmp_path / "again", numbered), topics)
