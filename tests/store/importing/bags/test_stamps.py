import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.importing.bags.stamps import oddities, seconds, stamp_of
from tests.store.importing.bags.made import START_NS, header, joints, make, ns, number

STEP = 10_000_000


def told(stamps: list[int], apart_ns: int = 0) -> list[str]:
    stamps_ns = START_NS + np.array(stamps, np.int64)
    return list(oddities("/t", stamps_ns, stamps_ns - apart_ns, START_NS))


def test_even_stamps_are_not_odd() -> None:
    """Evenly spaced stamps, and few of them, are worth no word."""
    assert told([i * STEP for i in range(50)]) == []
    assert told([0, STEP, 90 * STEP]) == []
    assert told([]) == []


def test_a_gap_is_told_with_its_length_and_place() -> None:
    """What is much longer than the usual interval is a gap."""
    stamps = [i * STEP + (50 * STEP if i >= 20 else 0) for i in range(40)]
    assert told(stamps) == ["/t: 1 gap, the longest of 0.51 s at 0.19 s, where 0.01 s are usual"]


def test_time_that_goes_back_or_stands_is_told() -> None:
    """Stamps before or at the one ahead of them are counted."""
    assert told([0, 2 * STEP, STEP, STEP, 3 * STEP]) == [
        "/t: 1 time stamp is before the one ahead of it: the bag's order is kept",
        "/t: 1 time stamp is the same as the one ahead of it",
    ]


def test_another_clock_is_told() -> None:
    """Stamps that are more than a minute from when messages were written are of another clock."""
    assert told([0, STEP], -59 * 10**9) == []
    (notice,) = told([0, STEP], -(10**12))
    assert notice.startswith("/t: the stamps are -1000 s apart from when the messages were written")


@given(st.lists(st.integers(0, 10**12), max_size=40))
def test_any_stamps_can_be_told_about(stamps: list[int]) -> None:
    """Sorted stamps never go back, and those that differ are never the same."""
    words = " ".join(told(sorted(set(stamps))))
    assert "ahead" not in words


@given(st.integers(-(10**15), 10**15))
def test_nanoseconds_are_not_lost(after: int) -> None:
    """The difference of two times is exact to the nanosecond, though both are far from 1970."""
    (found,) = seconds(np.array([START_NS + after]), START_NS)
    assert round(found * 1e9) == after


@pytest.mark.parametrize(
    ("message", "stamp"),
    [
        (joints(ns(1), [], []), ns(1)),
        (make("std_msgs/msg/Header", stamp=header(5).stamp, frame_id=""), 5),
        ({"timestamp": {"sec": 2, "nsec": 3}}, 2_000_000_003),
        ({"header": {"stamp": {"secs": 2, "nsecs": 3}}}, 2_000_000_003),
        ({"header": {"stamp": {"sec": 0, "nanosec": 0}}}, 0),
        ({"header": {"stamp": "today"}}, None),
        (number(1.0), None),
        (3, None),
    ],
)
def test_stamps_are_found(message: object, stamp: int | None) -> None:
    """The stamp is that of the header, else the message's own, in the words of ROS 1, ROS 2 and JSON schemas."""
    assert stamp_of(message) == stamp
