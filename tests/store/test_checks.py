from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.store.checks import check
from palpate.store.entries import Bound, Distribution, FailedEntry, Interval, Value
from palpate.store.errors import StoreError
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef
from tests.store.made_up import GRIPPER, recordings, squeeze

HALF_PAIR = "\ud800"
LONG = "a" * 201
TWO: Any = (0.0, 0.0)
ENDLESS: dict[str, Any] = {}
ENDLESS["in"] = ENDLESS


def one_channel(**changes: Any) -> tuple[Series, ...]:
    fields = {"name": "force", "quantity": "force", "unit": "N", "values": np.zeros(3), **changes}
    return (Series("sensor", (Channel(**fields),)),)


def two_channels(*lengths: int, **changes: Any) -> tuple[Series, ...]:
    return (
        Series("sensor", tuple(Channel(f"c{i}", "q", None, np.zeros(n), **changes) for i, n in enumerate(lengths))),
    )


REFUSED = [
    ({"recorded_at": datetime(2024, 5, 1)}, "recorded_at: 2024-05-01T00:00:00 has no time zone"),
    ({"recorded_at": datetime.now(UTC) + timedelta(days=1)}, "recorded_at: .* is in the future"),
    ({"action": ""}, "action: is empty"),
    ({"action": 3}, "action: found 3, expected text"),
    ({"owner": HALF_PAIR}, "owner: character 0 is half of a pair"),
    ({"licence": "a\0"}, "licence: holds a null character"),
    ({"embargoed_until": datetime(2030, 1, 1)}, "embargoed_until: 2030-01-01T00:00:00 has no time zone"),
    ({"embargoed_until": datetime(1, 1, 1, tzinfo=UTC)}, "embargoed_until: found the year 1"),
    ({"visibility": "secret"}, "visibility: found 'secret'; choose from 'private', 'lab', 'public'"),
    ({"thing": ThingRef("", "a")}, "thing.dataset: is empty"),
    ({"thing": ThingRef("a", "b", attributes={"x": float("inf")})}, "thing.attributes.x: found inf"),
    ({"thing": ThingRef("a", "b", attributes=[])}, "thing.attributes: found list, expected names"),  # type: ignore[arg-type]
    ({"action": "a\n"}, r"action: letter 2 is U\+000A a control, which nobody sees in 'a\\n'; expected"),
    ({"owner": "a\u200bnn"}, r"owner: letter 2 is U\+200B ZERO WIDTH SPACE, which nobody sees"),
    ({"thing": ThingRef("\u202eycb", "a")}, r"thing.dataset: letter 1 is U\+202E RIGHT-TO-LEFT OVERRIDE"),
    ({"thing": ThingRef("ycb", "a\u2066")}, r"thing.id: letter 2 is U\+2066 LEFT-TO-RIGHT ISOLATE"),
    ({"thing": ThingRef("ycb", "a", "b\u200f")}, r"thing.maker: letter 2 is U\+200F RIGHT-TO-LEFT MARK"),
    ({"thing": ThingRef("ycb", "a", None, "\u00ad")}, r"thing.common_name: letter 1 is U\+00AD SOFT HYPHEN"),
    ({"thing": ThingRef("ycb", "a", aliases=("b\x1b",))}, r"thing.aliases\[0\]: letter 2 is U\+001B"),
    ({"setup": Setup(gripper=Device("gripper", "\ufeffx"))}, r"setup.gripper.name: letter 1 is U\+FEFF"),
    ({"setup": Setup(other=(Device("other", "x", "a\u200db"),))}, r"setup.other\[0\].maker: letter 2 is U\+200D"),
    ({"thing": ThingRef("a", "b", aliases=("",))}, r"thing.aliases\[0\]: is empty"),
    ({"action": LONG}, "action: found 'aaaaaaaaaaaaaaaaaaaa' and so on, 201 letters; expected a name of 200 at most"),
    ({"owner": LONG}, "owner: found 'a{20}' and so on, 201 letters"),
    ({"thing": ThingRef(LONG, "a")}, "thing.dataset: found .* 201 letters"),
    ({"thing": ThingRef("ycb", LONG)}, "thing.id: found .* 201 letters"),
    ({"thing": ThingRef("ycb", "a", LONG)}, "thing.maker: found .* 201 letters"),
    ({"thing": ThingRef("ycb", "a", None, LONG)}, "thing.common_name: found .* 201 letters"),
    ({"thing": ThingRef("ycb", "a", aliases=("b", LONG))}, r"thing.aliases\[1\]: found .* 201 letters"),
    ({"setup": Setup(gripper=Device("gripper", LONG))}, "setup.gripper.name: found .* 201 letters"),
    ({"setup": Setup(other=(Device("other", "x", LONG),))}, r"setup.other\[0\].maker: found .* 201 letters"),
    ({"entries": (Value(LONG, 1.0),)}, r"entries\[0\].property: found .* 201 letters"),
    ({"entries": (FailedEntry("no contact", LONG),)}, r"entries\[0\].property: found .* 201 letters"),
    ({"entries": (Distribution("material", {LONG: 1.0}),)}, r"entries\[0\].probabilities: found .* 201 letters"),
    ({"setup": Setup(arm=GRIPPER)}, "setup.arm.kind: found 'gripper', expected 'arm'"),
    ({"setup": Setup(other=(Device("hand", "x"),))}, r"setup.other\[0\].kind: found 'hand'"),
    (
        {"setup": Setup(other=(Device("other", "x", calibrated_on="soon"),))},
        r"setup.other\[0\].calibrated_on: found 'soon'",
    ),
    ({"grasp": {1: 2}}, "grasp: found the key 1"),
    ({"grasp": ENDLESS}, r"grasp\.in\.in\..*: is nested too deep, expected at most 100 levels"),
    ({"grasp": {"at": datetime(2024, 5, 1)}}, "grasp.at: found datetime"),
    ({"object_pose": Pose((0.0, float("nan"), 0.0))}, "object_pose.translation_m: found nan"),
    ({"gripper_pose": Pose((0.0, 0.0, 0.0), (1.0, 1.0, 0.0, 0.0))}, "gripper_pose.quaternion: length 1.414"),
    ({"gripper_pose": Pose(TWO)}, "gripper_pose.translation_m: 2 numbers, expected 3"),
    ({"series": one_channel(unit="nonsense")}, r"series\[0\].force.unit: unknown unit 'nonsense'"),
    ({"series": one_channel(unit="mm")}, r"series\[0\].force.unit: unit 'mm' is length"),
    ({"series": one_channel(unit="")}, r"series\[0\].force.unit: is empty"),
    ({"series": one_channel(values=["a", "b"])}, r"series\[0\].force.values: samples of <U1"),
    ({"series": one_channel(values=3.0)}, r"series\[0\].force.values: a single number"),
    ({"series": one_channel(rate_hz=0.0)}, r"series\[0\].force.rate_hz: found 0.0"),
    ({"series": one_channel(time_s=[0.0, 1.0])}, r"series\[0\].force.time_s: shape \(2,\) for 3 samples"),
    ({"series": one_channel(time_s=[0.0, 1.0, np.nan])}, r"series\[0\].force.time_s: a time stamp is not finite"),
    ({"series": two_channels(3, 4)}, r"series\[0\].c1.values: 4 samples, expected 3 as in 'c0'"),
    ({"series": (*one_channel(), *one_channel())}, r"series\[1\].name: found 'sensor'"),
    ({"files": (FileItem("a", "image/png", Path("nowhere.png")),)}, r"files\[0\].data: there is no file 'nowhere.png'"),
    ({"files": (FileItem("a", "x/y", b""), FileItem("a", "x/y", b""))}, r"files\[1\].name: a second file 'a'"),
    ({"entries": (Value("mass", float("nan"), unit="g"),)}, r"entries\[0\].value: found nan"),
    ({"entries": (Value("mass", True, unit="g"),)}, r"entries\[0\].value: found True"),
    ({"entries": (Value("mass", 1.0, -1.0, "g"),)}, r"entries\[0\].sd: found -1.0"),
    ({"entries": (Value("mass", 1.0, None, "nonsense"),)}, r"entries\[0\].unit: unknown unit"),
    ({"entries": (Interval("mass", 2.0, 1.0, "g"),)}, r"entries\[0\].low: 2.0 is above 1.0"),
    ({"entries": (Bound("mass", unit="g"),)}, r"entries\[0\]: above is None and below is None"),
    ({"entries": (Bound("mass", 1.0, 2.0, "g"),)}, r"entries\[0\]: above is 1.0 and below is 2.0"),
    ({"entries": (Distribution("kind", {"a": 0.5, "b": 0.4}),)}, r"entries\[0\].probabilities: sum to 0.9"),
    ({"entries": (Distribution("kind", {"a": 1.5, "b": -0.5}),)}, r"entries\[0\].probabilities\['b'\]: found -0.5"),
    ({"entries": (Distribution("kind", {}),)}, r"entries\[0\].probabilities: sum to 0"),
    ({"entries": (FailedEntry(""),)}, r"entries\[0\].reason: is empty"),
    ({"notices": ("fine", 3)}, r"notices\[1\]: found 3"),
    ({"log": HALF_PAIR}, "log: character 0 is half of a pair"),
    (
        {"entries": (Value("mass", 1.7e308, unit="g"),)},
        r"entries\[0\].value: found 1.7e\+308, expected a number of which",
    ),
    ({"entries": (Bound("volume", -1e200, unit="m^3"),)}, r"entries\[0\].above: found -1e\+200"),
    ({"entries": (Value("mass", 1.0, unit="g"),) * 1001}, "entries: found 1001, expected 1000 at most"),
    ({"notices": ("odd",) * 1001}, "notices: found 1001, expected 1000 at most"),
    ({"thing": ThingRef("a", "b", aliases=("c",) * 1001)}, "thing.aliases: found 1001, expected 1000 at most"),
    ({"log": "." * (1 + (16 << 20))}, "log: found 16777217 letters, expected 16777216 at most"),
    ({"grasp": {"at": "é" * (1 << 19)}}, "recording: 10[0-9]* bytes of JSON, expected 1048576 at most"),
    ({"thing": ThingRef("a", "b", attributes={"at": "." * (1 << 20)})}, "thing: 10[0-9]* bytes of JSON"),
    ({"setup": Setup(arm=Device("arm", "x", calibration={"at": "." * (1 << 20)}))}, "setup: 10[0-9]* bytes of JSON"),
]


@pytest.mark.parametrize(("changes", "message"), REFUSED, ids=[message for _, message in REFUSED])
def test_what_cannot_be_kept_is_refused(changes: dict[str, Any], message: str) -> None:
    """The error is one sentence that names the field, what was found and what would be right."""
    with pytest.raises(StoreError, match=f"^{message}") as raised:
        check(replace(squeeze(), **changes))
    assert "\n" not in str(raised.value)


def test_what_a_store_has_kept_may_be_larger() -> None:
    """An archive of before is read as it is; a measurement of many results is none too many."""
    many = replace(squeeze(), entries=(Value("mass", 1.0, unit="g"),) * 1001, grasp={"at": "." * (1 << 20)})
    check(many, is_new=False)
    check(replace(squeeze(), entries=(Value("mass", 1.0, unit="g"),) * 1000))


def test_known_units_of_properties_are_heeded() -> None:
    """A property whose dimension is known is refused in another one."""
    check(squeeze(), units={"elasticity": "MPa"})
    with pytest.raises(StoreError, match=r"entries\[0\].unit: unit 'kPa' is .*; expected mass"):
        check(squeeze(), units={"elasticity": "g"})


def test_rates_of_their_own_allow_lengths_of_their_own() -> None:
    """Channels of different rates, or with time stamps, may have different numbers of samples; NaN samples are kept."""
    slow = Channel("slow", "q", None, np.full(3, np.nan), rate_hz=1.0)
    fast = Channel("fast", "q", None, np.zeros(30), rate_hz=10.0)
    stamped = Channel("stamped", "q", None, np.zeros(2), time_s=np.array([0.0, 0.5]))
    check(squeeze(series=(Series("sensor", (slow, fast, stamped)),)))


@settings(max_examples=30, deadline=None)
@given(recordings())
def test_made_up_recordings_may_be_kept(recording: Recording) -> None:
    """What the other tests put into stores passes the checks."""
    check(recording)


@settings(max_examples=30, deadline=None)
@given(recordings(), st.sampled_from(["id", "visibility"]))
def test_the_digest_is_of_the_content(recording: Recording, name: str) -> None:
    """Id and visibility do not change a digest; what was measured does."""
    changes: dict[str, Any] = {"id": squeeze().id} if name == "id" else {"visibility": "lab"}
    assert replace(recording, **changes).digest == recording.digest
    assert replace(recording, log=recording.log + "x").digest != recording.digest
    assert replace(recording, notices=(*recording.notices, "x")).digest != recording.digest


def test_the_digest_sees_every_sample() -> None:
    """One other bit of a sample or of a time stamp is another recording; the order of bytes in memory is not."""
    values = np.arange(4.0)
    one = squeeze(series=one_channel(values=values))
    assert one.digest == squeeze(series=one_channel(values=values.astype(">f8"))).digest
    assert one.digest == squeeze(series=one_channel(values=np.repeat(values, 2)[::2])).digest
    assert one.digest != squeeze(series=one_channel(values=np.nextafter(values, 9.0))).digest
    assert one.digest != squeeze(series=one_channel(values=values.astype(np.float32))).digest
    assert one.digest != squeeze(series=one_channel(values=values, time_s=values)).digest


def test_what_a_store_has_kept_may_have_long_names() -> None:
    """They were taken before; what has 200 letters, of whatever script, is taken now."""
    for name, is_new in ((LONG, False), ("\u6771" * 200, True)):
        thing, gripper = ThingRef(name, name, name, name, aliases=(name,)), Device("gripper", name, name)
        entries = (Value(name, 1.0), Distribution("material", {name: 1.0}))
        check(
            squeeze(action=name, owner=name, thing=thing, setup=Setup(gripper=gripper), entries=entries), is_new=is_new
        )


def test_what_a_store_has_kept_may_have_hidden_letters() -> None:
    """They were taken before; and names in any script, emoji among them, are taken now."""
    old = squeeze(
        thing=ThingRef("\u202eycb", "a\n"), owner="a\u200bnn", setup=Setup(gripper=Device("gripper", "\u2069"))
    )
    check(old, is_new=False)
    book = "\u06a9\u062a\u0627\u0628\u200c\u062e\u0627\u0646\u0647"
    named = ThingRef("dílna", book, "東京", "\U0001f469\u200d\U0001f52c cup", aliases=("é", "no\u00a0break"))
    check(squeeze(thing=named, setup=Setup(gripper=Device("gripper", "हिन्दी\u200dक"))))
