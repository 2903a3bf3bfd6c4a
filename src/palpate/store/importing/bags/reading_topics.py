"""Reading the map of topics from TOML.

The format; only ``action``, ``[object]`` and one topic must be there::

    action = "squeezing"                # or {topic = "/action", field = "data"}
    owner = "our lab"                   # as licence, visibility, ground_truth, software, repository
    clock = "header"                    # or "log": when the message was written; each topic may have its own
    distribution = "humble"             # whose types a bag without definitions uses

    [object]
    dataset = "ycb"
    id = "025_mug"                      # or {topic = "/object_id", field = "data"}; maker, common_name, aliases
                                        # and a table of attributes may follow
    [setup.arm]                         # as in a recorder's setup.toml
    name = "kinova_gen3"

    [topics."/joint_states"]
    required = true                     # a bag without it is refused
    [topics."/joint_states".series.kinova_gen3]
    torque_4 = {field = "effort[joint_4]", quantity = "torque", unit = "N*m"}

    [topics."/camera/image_raw"]        # Image, CompressedImage, PointCloud2
    files = {folder = "imgs/cam0", every = 10}
    [topics."/audio"]                   # AudioData, AudioDataStamped, AudioStamped
    sound = {file = "audio/scratch.wav", rate_hz = 44100, channels = 1, sample = "int16"}
    [topics."/tool_pose"]               # PoseStamped, TransformStamped, or a pose in a field
    pose = {of = "gripper_pose", frame = "base", take = "last"}
    [topics."/stiffness"]
    result = {property = "elasticity", field = "data", unit = "kPa", sd = 10.0}
    [topics."/rosout"]
    log = true

    [[recordings]]                      # several in one bag, in seconds since its first message
    start_s = 0.0
    stop_s = 4.5
    action = "weighing"                 # optional, as object
    [marker]                            # or between messages of a topic
    topic = "/trial"
    start = "begin"
    stop = "end"

    [definitions]                       # of types that a bag does not define
    "audio_common_msgs/msg/AudioData" = "uint8[] data"
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from palpate.errors import NetworkError
from palpate.network.document import Section, open_layer
from palpate.store.errors import StoreError
from palpate.store.importing.bags.reading_topic import path_in, read_topic
from palpate.store.importing.bags.topics import Cut, Marker, TextFrom, Topic, TopicMap
from palpate.store.importing.setup_tables import setup_from_tables
from palpate.store.records import ThingRef

__all__ = ["read_topic_map"]

TEXTS = ("owner", "licence", "software", "repository", "distribution")
KEYS = (
    *("action", "object", "setup", "visibility", "ground_truth", "clock", "topics", "recordings", "marker"),
    *("definitions", *TEXTS),
)
THING = ("dataset", "id", "maker", "common_name", "aliases", "attributes")


def read_topic_map(path: str | Path) -> TopicMap:
    """Read a map of topics from a TOML file (format: see this module).

    Raises
    ------
    StoreError
        If it cannot be used; the message names the file, the key, what was found and what was expected.
    """
    try:
        layer = open_layer(Path(path))
        return _map(Section(layer.tables, [layer]))
    except NetworkError as error:
        raise StoreError(str(error)) from error


def _map(section: Section) -> TopicMap:
    section.only(KEYS)
    action, action_from = _text(section, "action")
    thing, id_from = _thing(section.section("object"))
    topics = tuple(read_topic(name, inner, section) for name, inner in section.sections("topics").items())
    if not topics:
        raise section.error('found no topic; expected a table [topics."/name"] for each that is to be kept')
    _refuse_repeated(section, topics)
    if "recordings" in section and "marker" in section:
        raise section.error("found recordings by times and by a marker; expected one of them", "marker")
    tables = section.section("setup").tables if "setup" in section else {}
    return TopicMap(
        action=action,
        thing=thing,
        topics=topics,
        action_from=action_from,
        id_from=id_from,
        setup=setup_from_tables(tables, f"{section.layers[0].file}: setup"),
        visibility=section.text("visibility", "private"),
        ground_truth=section.flag("ground_truth"),
        cuts=_cuts(section),
        marker=_marker(section.section("marker")) if "marker" in section else None,
        definitions=_definitions(section),
        **{key: section.text(key) if key in section else None for key in TEXTS},
    )


def _text(section: Section, key: str) -> tuple[str, TextFrom | None]:
    """A text, or where in the bag it stands."""
    if not isinstance(section.need(key, "a string, or the topic that tells it"), Mapping):
        return section.text(key), None
    inner = section.section(key)
    inner.only(["topic", "field"])
    return "", TextFrom(inner.text("topic"), path_in(inner, "field", "data"))


def _thing(section: Section) -> tuple[ThingRef, TextFrom | None]:
    section.only(THING)
    known_as, id_from = _text(section, "id")
    maker, common_name = (section.text(key) if key in section else None for key in ("maker", "common_name"))
    attributes = section.section("attributes").tables if "attributes" in section else {}
    aliases = section.names("aliases", ())
    return ThingRef(section.text("dataset"), known_as, maker, common_name, attributes, aliases), id_from


def _refuse_repeated(section: Section, topics: tuple[Topic, ...]) -> None:
    """Refuse two sources of one channel, file, or pose, as both cannot be kept."""
    taken: dict[str, str] = {}
    for topic in topics:
        names = [f"channel {channel.name!r} of series {channel.series!r}" for channel in topic.channels]
        names += [f"folder {topic.files.folder!r}"] if topic.files else []
        names += [f"file {topic.sound.file!r}"] if topic.sound else []
        names += [topic.pose.of.value] if topic.pose else []
        for name in names:
            if name in taken:
                raise section.error(
                    f"found the {name} again, as in {taken[name]}; expected it once", "topics", topic.name
                )
            taken[name] = topic.name


def _cuts(section: Section) -> tuple[Cut, ...]:
    tables = section.tables.get("recordings", [])
    if not isinstance(tables, list) or not all(isinstance(table, Mapping) for table in tables):
        raise section.error("found no list of tables; expected [[recordings]]", "recordings")
    return tuple(_cut(Section(table, section.layers, (f"recordings[{place}]",))) for place, table in enumerate(tables))


def _cut(section: Section) -> Cut:
    section.only(["start_s", "stop_s", "action", "object"])
    start_s, stop_s = section.number("start_s"), section.number("stop_s") if "stop_s" in section else None
    if start_s < 0 or (stop_s is not None and stop_s <= start_s):
        raise section.error(f"found {start_s:g} to {stop_s} s; expected a start of 0 or more and a stop after it")
    action = section.text("action") if "action" in section else None
    thing, id_from = _thing(section.section("object")) if "object" in section else (None, None)
    if id_from is not None:
        raise section.error("found a topic; expected a text, as one topic tells it for all recordings", "object", "id")
    return Cut(start_s, stop_s, action, thing)


def _marker(section: Section) -> Marker:
    section.only(["topic", "field", "start", "stop"])
    marks: list[Any] = [section.need(key, "what such a message holds") for key in ("start", "stop")]
    if not all(isinstance(mark, str | int) for mark in marks) or marks[0] == marks[1]:
        raise section.error(f"found {marks[0]!r} and {marks[1]!r}; expected two different texts, integers or booleans")
    return Marker(section.text("topic"), path_in(section, "field", "data"), marks[0], marks[1])


def _definitions(section: Section) -> dict[str, str]:
    if "definitions" not in section:
        return {}
    inner = section.section("definitions")
    return {name: inner.text(name) for name in inner}
