from pathlib import Path

import numpy as np
import pytest

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_topic_map
from palpate.store.importing.bags.topics import Clock, Posed, Take
from tests.store.importing.bags.made import HEAD, topic_map

WHOLE = """
owner = "our lab"
licence = "CC-BY-4.0"
visibility = "lab"
ground_truth = true
clock = "log"
distribution = "humble"
action = "squeezing"

[object]
dataset = "ycb"
id = {topic = "/object", field = "data"}
common_name = "mug"
attributes = {colour = "red"}

[setup.arm]
name = "kinova_gen3"

[topics."/joint_states"]
required = true
clock = "header"
[topics."/joint_states".series.arm]
torque = {field = "effort[joint_4]", unit = "N*m"}
[topics."/joint_states".series.gripper]
opening = {field = "position[finger_joint]", quantity = "position", unit = "rad"}

[topics."/camera"]
files = "imgs/cam0"

[topics."/audio"]
sound = {file = "audio/scratch.wav", rate_hz = 44100, channels = 2, sample = "int16"}

[topics."/tool"]
pose = {of = "gripper_pose", frame = "base", take = "last"}

[topics."/stiffness"]
result = {property = "elasticity", unit = "kPa", sd_field = "sd", take = "all"}

[topics."/rosout"]
log = true

[[recordings]]
start_s = 1
stop_s = 2.5
action = "weighing"
object = {dataset = "ycb", id = "011_banana"}

[definitions]
"audio_common_msgs/msg/AudioData" = "uint8[] data"
"""


def test_a_whole_map_is_read(tmp_path: Path) -> None:
    """Every key of the format arrives where it belongs."""
    found = topic_map(tmp_path, WHOLE, head="")
    topics = {topic.name: topic for topic in found.topics}
    assert (found.owner, found.visibility, found.ground_truth, found.distribution) == ("our lab", "lab", True, "humble")
    assert (found.thing.dataset, found.thing.common_name, found.thing.attributes) == ("ycb", "mug", {"colour": "red"})
    assert found.id_from is not None
    assert found.id_from.topic == "/object"
    assert [device.name for device in found.setup.devices] == ["kinova_gen3"]
    assert [(one.series, one.name, one.quantity, one.unit) for one in topics["/joint_states"].channels] == [
        ("arm", "torque", "torque", "N*m"),
        ("gripper", "opening", "position", "rad"),
    ]
    assert [topic.clock for topic in found.topics] == [Clock.HEADER] + [Clock.LOG] * 5
    sound, pose, result = topics["/audio"].sound, topics["/tool"].pose, topics["/stiffness"].result
    assert sound is not None
    assert (sound.rate_hz, sound.channels, sound.sample) == (44100, 2, np.dtype("<i2"))
    assert pose is not None
    assert (pose.of, pose.take, pose.frame) == (Posed.GRIPPER, Take.LAST, "base")
    assert result is not None
    assert (result.path.text, result.take) == ("data", Take.ALL)
    (cut,) = found.cuts
    assert (cut.start_s, cut.stop_s, cut.action, cut.thing and cut.thing.id) == (1, 2.5, "weighing", "011_banana")
    assert found.told_by == {"/object"}


TOPIC = '[topics."/a"]\n'


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("", "found no topic"),
        (TOPIC, "found nothing that it becomes"),
        (f"{TOPIC}flies = 'x'", r"topics\./a\.flies: found the unknown key 'flies' \(did you mean 'files'\?\)"),
        (f"{TOPIC}series.arm.x = 3", r"series\.arm\.x: found 3; expected a table such as"),
        (f"{TOPIC}series.arm.arm = 3", r"series\.arm\.arm: found 3; expected a table such as"),
        (f"{TOPIC}series.arm.x.unit = 'N'", "found no 'field'"),
        (f"{TOPIC}series.arm.x = {{field = 'a..b'}}", r"x\.field: found 'a\.\.b' is no field"),
        (f"{TOPIC}series.arm.x = {{field = 'a', unit = 'parsnip'}}", r"x\.unit: unknown unit 'parsnip'"),
        (f"{TOPIC}series.arm.force = {{field = 'a', unit = 'g'}}", r"force\.unit: unit 'g' is mass"),
        (f"{TOPIC}files = '../out'", r"files\.folder: found '\.\./out' leads out"),
        (f"{TOPIC}files = {{folder = 'x', every = 0}}", "expected a number above 0"),
        (f"{TOPIC}files = {{folder = 'x', every = 1.5}}", "expected a whole number"),
        (f"{TOPIC}sound = {{file = 'x.wav', sample = 'int12'}}", "'int12'; choose from 'uint8'"),
        (f"{TOPIC}pose = 'camera_pose'", "'camera_pose'; choose from 'object_pose'"),
        (f"{TOPIC}pose = {{of = 'object_pose', take = 'all'}}", "a recording has one pose"),
        (f"{TOPIC}result = {{property = 'x', sd = 1, sd_field = 'y'}}", "an SD and a field for it"),
        (f"{TOPIC}result = {{property = 'x', sd = -1}}", "expected a number from 0"),
        (f"{TOPIC}log = 1", "expected true or false"),
        (f"{TOPIC}clock = 'wall'\nlog = true", "'wall'; choose from 'header', 'log'"),
        (f'{TOPIC}files = "x"\n[topics."/b"]\nfiles = "x"', "again, as in /a"),
        (f'{TOPIC}series.s.c.field = "x"\n[topics."/b"]\nseries.s.c.field = "y"', "channel 'c' of series 's' again"),
        (f"{TOPIC}log = true\n[[recordings]]\nstart_s = 2\nstop_s = 1", "found 2 to 1.0 s; expected a start"),
        (f"{TOPIC}log = true\n[recordings]\nstart_s = 2", r"expected \[\[recordings\]\]"),
        (f"{TOPIC}log = true\n[marker]\ntopic = '/m'\nstart = 'a'\nstop = 'a'", "expected two different"),
        (f"{TOPIC}log = true\n[[recordings]]\nstart_s = 2\n[marker]\ntopic = '/m'", "expected one of them"),
        (f"{TOPIC}log = true\n[setup.griper]\nname = 'x'", "did you mean 'gripper'"),
        (f"{TOPIC}log = true\n[definitions]\n'a/msg/B' = 3", "expected a string"),
    ],
)
def test_what_is_wrong_is_named(tmp_path: Path, text: str, told: str) -> None:
    """A mistake in a map is one sentence with the file, the key, and what would be right."""
    with pytest.raises(StoreError, match=told) as refused:
        topic_map(tmp_path, text)
    assert str(refused.value).startswith(str(tmp_path / "topics.toml"))


@pytest.mark.parametrize("text", ["action = ", b"\xff", None])
def test_what_is_no_toml_is_refused(tmp_path: Path, text: str | bytes | None) -> None:
    """A file that is not there or is no TOML is one sentence with its name."""
    file = tmp_path / "map.toml"
    if text is not None:
        file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(StoreError, match=r"map\.toml: .*expected TOML"):
        read_topic_map(file)


def test_what_must_be_there_is_asked_for(tmp_path: Path) -> None:
    """Action and object are required, as a recording is nothing without."""
    for line in ("action", "dataset", "id"):
        head = "\n".join(text for text in HEAD.splitlines() if not text.startswith(line))
        with pytest.raises(StoreError, match=f"found no '{line}'"):
            topic_map(tmp_path, "\n[topics.'/a']\nlog = true", head)
