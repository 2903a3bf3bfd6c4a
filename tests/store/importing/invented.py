"""Invented recordings: one by hand, and any that a store would keep."""

from datetime import UTC, date, datetime
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from palpate.store.entries import Bound, Distribution, FailedEntry, Interval, Value
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef

MOMENT = datetime(2024, 5, 1, 12, 30, 15, 250_000, tzinfo=UTC)
MUG = ThingRef("ycb", "025_mug", common_name="mug")


def squeeze(**fields: Any) -> Recording:
    """One with something in each of its fields."""
    stamped = Channel(
        "image", "depth", "mm", np.arange(12, dtype="<u2").reshape(3, 2, 2), time_s=np.array([0.0, 0.5, 1])
    )
    position = Channel("position", "position", "mm", np.linspace(0.0, 85.0, 150), rate_hz=100.0)
    pose = Pose((0.1, 0.2, 0.3), (1.0, 0.0, 0.0, 0.0), "base", {"rotation": [1, 2, 3]})
    given: dict[str, Any] = {
        "recorded_at": MOMENT,
        "action": "squeezing",
        "thing": MUG,
        "setup": Setup(gripper=Device("gripper", "robotiq_2f85", calibration={"offset_mm": 0.5})),
        "series": (Series("gripper", (position,)), Series("camera", (stamped,))),
        "files": (FileItem("imgs/cam0.png", "image/png", b"\x89PNG..."), FileItem("cam0.png", "image/png", b"")),
        "entries": (Value("elasticity", 42.0, 10.0, "kPa"),),
        "gripper_pose": pose,
        "log": "closing\n",
        "notices": ("the room was cold",),
    }
    return Recording(**{**given, **fields})


shown = st.text(st.characters(exclude_categories=["Cs", "Cc", "Cf", "Zl", "Zp"]), min_size=1, max_size=12)
words = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), min_size=1, max_size=12)
numbers = st.floats(allow_nan=False, allow_infinity=False, width=64)
# of results, in any of their units: a store keeps none that is more than 1e100 in SI units
measured = st.floats(-1e96, 1e96)
positive = st.floats(1e-3, 1e6)
plain = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**53), 2**53) | numbers | words,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3),
    max_leaves=5,
)
tables = st.dictionaries(words, plain, max_size=3)


def probabilities(weights: dict[str, float]) -> dict[str, float]:
    total = sum(weights.values())
    return {label: weight / total for label, weight in weights.items()}


entries = st.one_of(
    st.builds(Value, words, measured, st.none() | positive, st.sampled_from([None, "kPa", "g"])),
    st.builds(Distribution, words, st.dictionaries(words, positive, min_size=1, max_size=5).map(probabilities)),
    st.builds(lambda name, ends: Interval(name, min(ends), max(ends)), words, st.tuples(measured, measured)),
    st.builds(lambda name, end: Bound(name, above=end, unit="kPa"), words, measured),
    st.builds(FailedEntry, words, st.none() | words),
)
turns = st.none() | st.just((1.0, 0.0, 0.0, 0.0))
poses = st.none() | st.builds(Pose, st.tuples(numbers, numbers, numbers), turns, words, tables)


@st.composite
def channels(draw: st.DrawFn, name: str) -> Channel:
    dtype = draw(st.sampled_from(["<f8", ">f4", "<i4", "u1", "?"]))
    values = draw(hnp.arrays(dtype, hnp.array_shapes(max_dims=2, min_side=0, max_side=4)))
    stamps = draw(st.none() | hnp.arrays(np.float64, len(values), elements=numbers))
    # a rate for each length, as channels of one rate have one length
    rate_hz = None if stamps is not None else draw(st.sampled_from([1.0, 44_100.0])) * (1 + len(values))
    return Channel(name, draw(words), draw(st.sampled_from([None, "mm"])), values, rate_hz, stamps)


@st.composite
def all_series(draw: st.DrawFn) -> tuple[Series, ...]:
    names = draw(st.lists(words, unique=True, max_size=2))
    return tuple(
        Series(name, tuple(draw(channels(f"c{number}")) for number in range(draw(st.integers(0, 2))))) for name in names
    )


def devices(kind: str) -> st.SearchStrategy[Device]:
    return st.builds(
        Device, st.just(kind), shown, st.none() | shown, tables, tables, st.none() | st.dates().map(date.isoformat)
    )


@st.composite
def recordings(draw: st.DrawFn) -> Recording:
    """Any recording that a store keeps."""
    names = draw(st.lists(words, unique=True, max_size=3))
    return Recording(
        recorded_at=draw(st.datetimes(datetime(1971, 1, 1), datetime(2024, 1, 1), timezones=st.just(UTC))),
        action=draw(shown),
        thing=draw(st.builds(ThingRef, shown, shown, st.none() | shown, st.none() | shown, tables)),
        setup=draw(st.builds(Setup, arm=st.none() | devices("arm"), other=st.tuples(devices("other")))),
        owner=draw(st.none() | shown),
        visibility=draw(st.sampled_from(["private", "lab", "public"])),
        ground_truth=draw(st.booleans()),
        grasp=draw(st.none() | tables),
        gripper_pose=draw(poses),
        object_pose=draw(poses),
        series=draw(all_series()),
        files=tuple(FileItem(name, "text/plain", draw(st.binary(max_size=20))) for name in names),
        entries=tuple(draw(st.lists(entries, max_size=3))),
        log=draw(st.text(st.characters(exclude_categories=["Cs"]), max_size=30)),
        notices=tuple(draw(st.lists(words, max_size=2))),
    )
