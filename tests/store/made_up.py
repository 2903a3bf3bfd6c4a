"""Recordings that nobody made."""

from datetime import UTC, datetime, timedelta
from typing import Any

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.episodes import StoredEpisode
from palpate.store.quantities import QUANTITIES
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef

START = datetime(2024, 5, 1, 12, tzinfo=UTC)
GRIPPER = Device("gripper", "two_finger", maker="somebody", parameters={"stroke_mm": 85})


def squeeze(number: int = 0, **changes: Any) -> Recording:
    """A squeezing with three channels; another one for each number."""
    rng = np.random.default_rng(number)
    channels = (
        Channel("position", "length", "mm", rng.normal(size=50), rate_hz=100.0),
        Channel("current", "current", "A", rng.normal(size=50).astype(np.float32), rate_hz=100.0),
        Channel("force", "force", "N", rng.normal(size=(20, 3)), time_s=np.sort(rng.uniform(0, 1, 20))),
    )
    fields: dict[str, Any] = {
        "recorded_at": START + timedelta(seconds=number),
        "action": "squeezing",
        "thing": ThingRef("made_up", f"object{number % 3}"),
        "setup": Setup(gripper=GRIPPER),
        "series": (Series("two_finger", channels),),
        "entries": (Value("elasticity", 40.0 + number, 10.0, "kPa"),),
    }
    return Recording(**{**fields, **changes})


def made_episode(*recordings: Recording, number: int = 0, stop: str | None = None, **changes: Any) -> StoredEpisode:
    """An exploration with a step for each recording; another one for each number."""
    header = {"format": "palpate-episode/1", "network": {"name": "household"}, "objective": "mass", "number": number}
    fields: dict[str, Any] = {"started_at": START + timedelta(hours=number), "thing": ThingRef("made_up", "object0")}
    episode = StoredEpisode(header=header, **{**fields, **changes})
    for place, recording in enumerate(recordings, 1):
        line = {"step": place, "action": recording.action, "outcome": {"action": recording.action, "value": 0.1}}
        episode = episode.continued(line, recording.digest)
    return episode if stop is None else episode.continued({"stop": stop})


texts = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=8)
names = texts.filter(bool)
# of what people and programs call things by, whose letters are all seen
HIDDEN: Any = ["Cs", "Cc", "Cf", "Zl", "Zp"]
shown = st.text(st.characters(exclude_categories=HIDDEN), min_size=1, max_size=8)
finite = st.floats(allow_nan=False, allow_infinity=False, width=32)
json_values = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**60), 2**60) | finite | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(names, inner, max_size=3),
    max_leaves=6,
)
attributes = st.dictionaries(names, json_values, max_size=3)
# a quantity of one dimension would ask for units of that dimension
quantities = names.filter(lambda name: name not in QUANTITIES)
units = st.sampled_from(["g", "kPa", "dimensionless", None])
dtypes = st.sampled_from(["<f8", ">f8", "<f4", "<f2", "<i8", ">i2", "|u1", "|b1"])


@st.composite
def channels(draw: st.DrawFn, name: str) -> Channel:
    count = draw(st.integers(0, 4))
    shape = (count, *draw(st.lists(st.integers(0, 3), max_size=2)))
    values = draw(npst.arrays(np.dtype(draw(dtypes)), shape))
    time_s = draw(npst.arrays(np.float64, (count,), elements=finite))
    return Channel(name, draw(quantities), draw(units), values, draw(st.none() | st.just(100.0)), time_s)


@st.composite
def series(draw: st.DrawFn, name: str) -> Series:
    return Series(name, tuple(draw(channels(each)) for each in draw(st.lists(names, max_size=3, unique=True))))


@st.composite
def entries(draw: st.DrawFn) -> Entry:
    # one dimension for each property, as a store asks for
    unit, name = draw(units), draw(names)
    name = f"{name} in {unit}"
    low, high = sorted([draw(finite), draw(finite)])
    weights = draw(st.dictionaries(names, st.integers(1, 9), min_size=1, max_size=4))
    total = sum(weights.values())
    kinds: list[Entry] = [
        Value(name, low, abs(high), unit),
        Value(name, high, None, unit),
        Interval(name, low, high, unit),
        Bound(name, above=low, unit=unit),
        Bound(name, below=high, unit=unit),
        Distribution(name, {label: weight / total for label, weight in weights.items()}),
        FailedEntry("it broke", draw(st.none() | st.just(name))),
    ]
    return draw(st.sampled_from(kinds))


@st.composite
def devices(draw: st.DrawFn, kind: str) -> Device:
    return Device(kind, draw(shown), draw(st.none() | shown), draw(attributes), draw(attributes))


@st.composite
def setups(draw: st.DrawFn) -> Setup:
    named = {kind: draw(st.none() | devices(kind)) for kind in ("arm", "gripper", "camera", "microphone")}
    return Setup(**named, other=tuple(draw(st.lists(devices("other"), max_size=2))))


@st.composite
def poses(draw: st.DrawFn) -> Pose:
    place = (draw(finite), draw(finite), draw(finite))
    return Pose(place, draw(st.sampled_from([None, (1.0, 0.0, 0.0, 0.0)])), draw(names), draw(attributes))


@st.composite
def recordings(draw: st.DrawFn) -> Recording:
    """Any recording that may be kept."""
    embargoes = st.datetimes(datetime(1971, 1, 1), datetime(2100, 1, 1), timezones=st.just(UTC))
    moments = st.datetimes(datetime(1970, 1, 2), datetime(2024, 1, 1), timezones=st.just(UTC))
    files = st.builds(FileItem, names, st.just("image/png"), st.binary(max_size=20))
    return Recording(
        recorded_at=draw(moments),
        action=draw(shown),
        thing=ThingRef(draw(shown), draw(shown), draw(st.none() | shown), draw(st.none() | shown), draw(attributes)),
        setup=draw(setups()),
        owner=draw(st.none() | shown),
        licence=draw(st.none() | texts),
        visibility=draw(st.sampled_from(["private", "lab", "public"])),
        embargoed_until=draw(st.none() | embargoes),
        ground_truth=draw(st.booleans()),
        software=draw(st.none() | texts),
        repository=draw(st.none() | texts),
        grasp=draw(st.none() | attributes),
        gripper_pose=draw(st.none() | poses()),
        object_pose=draw(st.none() | poses()),
        series=tuple(draw(series(name)) for name in draw(st.lists(names, max_size=2, unique=True))),
        files=tuple(draw(st.lists(files, max_size=2, unique_by=lambda item: item.name))),
        entries=tuple(draw(st.lists(entries(), max_size=3))),
        log=draw(st.text(st.characters(exclude_categories=["Cs"]), max_size=20)),
        notices=tuple(draw(st.lists(texts, max_size=2))),
    )
