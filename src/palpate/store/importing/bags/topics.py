"""Which topics of a bag become what: the map that a lab writes once for its robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from palpate.store.importing.bags.fields import FieldPath
from palpate.store.records import Setup, ThingRef

__all__ = [
    "ChannelFrom",
    "Clock",
    "Cut",
    "FilesFrom",
    "Marker",
    "PoseFrom",
    "Posed",
    "ResultFrom",
    "SoundFrom",
    "Take",
    "TextFrom",
    "Topic",
    "TopicMap",
]


class Clock(Enum):
    """Whose time stamps are kept."""

    HEADER = "header"
    LOG = "log"


class Take(Enum):
    """Which of several messages is the one."""

    FIRST = "first"
    LAST = "last"
    ALL = "all"


class Posed(Enum):
    """What a pose is of: the field of a recording."""

    OBJECT = "object_pose"
    GRIPPER = "gripper_pose"


@dataclass(frozen=True)
class ChannelFrom:
    """A field of each message that becomes samples of a channel."""

    series: str
    name: str
    path: FieldPath
    quantity: str
    unit: str | None


@dataclass(frozen=True)
class FilesFrom:
    """Images or point clouds that become files of a folder; every `every`-th of them."""

    folder: str
    every: int = 1


@dataclass(frozen=True)
class SoundFrom:
    """Pieces of a sound that become one file.

    Attributes
    ----------
    file
        Its name; ``.wav`` unless the pieces are encoded already, as MP3 is.
    rate_hz, channels, sample
        What the messages do not say by themselves: samples per second, how many channels take turns, the type of
        a sample, little-endian.
    """

    file: str
    rate_hz: int | None = None
    channels: int | None = None
    sample: np.dtype[np.generic] | None = None


@dataclass(frozen=True)
class PoseFrom:
    """A pose of the object or the gripper; `frame` where the messages name none or a wrong one."""

    of: Posed
    path: FieldPath | None = None
    frame: str | None = None
    take: Take = Take.FIRST


@dataclass(frozen=True)
class ResultFrom:
    """A field that is a result: a number with its unit, a label, or a vector of probabilities of `labels`."""

    property: str
    path: FieldPath
    unit: str | None = None
    sd: float | None = None
    sd_path: FieldPath | None = None
    labels: tuple[str, ...] = ()
    take: Take = Take.LAST


@dataclass(frozen=True)
class Topic:
    """What becomes of the messages of one topic."""

    name: str
    required: bool = False
    clock: Clock = Clock.HEADER
    channels: tuple[ChannelFrom, ...] = ()
    files: FilesFrom | None = None
    sound: SoundFrom | None = None
    pose: PoseFrom | None = None
    result: ResultFrom | None = None
    log: bool = False


@dataclass(frozen=True)
class TextFrom:
    """A text that the bag holds itself: a field of the messages of a topic."""

    topic: str
    path: FieldPath


@dataclass(frozen=True)
class Cut:
    """One of several recordings in a bag, in seconds since the bag's first message; to its end where `stop_s` is None.

    `action` and `thing` replace those of the map.
    """

    start_s: float
    stop_s: float | None = None
    action: str | None = None
    thing: ThingRef | None = None


@dataclass(frozen=True)
class Marker:
    """Messages between which the recordings of a bag lie."""

    topic: str
    path: FieldPath
    start: str | int | bool
    stop: str | int | bool


@dataclass(frozen=True)
class TopicMap:
    """What the messages of a bag become.

    Attributes
    ----------
    action, thing
        What was done with which object.
    action_from, id_from
        Where the bag itself tells the action or the object's id, which then replace those of `action` and `thing`.
    setup, owner, licence, visibility, ground_truth, software, repository
        As in a recording.
    topics
        What becomes of each topic.
    cuts, marker
        Where the bag holds several recordings: by times, or between marks; one recording unless either is given.
    definitions
        Type of message to its definition, for bags that hold none.
    distribution
        The release of ROS 2, such as ``"humble"``, whose types are used by a bag that holds no definitions.
    """

    action: str
    thing: ThingRef
    topics: tuple[Topic, ...]
    action_from: TextFrom | None = None
    id_from: TextFrom | None = None
    setup: Setup = field(default_factory=Setup)
    owner: str | None = None
    licence: str | None = None
    visibility: str = "private"
    ground_truth: bool = False
    software: str | None = None
    repository: str | None = None
    cuts: tuple[Cut, ...] = ()
    marker: Marker | None = None
    definitions: Mapping[str, str] = field(default_factory=dict)
    distribution: str | None = None

    @property
    def told_by(self) -> set[str]:
        """Topics that tell about the recordings and need become nothing themselves."""
        return {one.topic for one in (self.action_from, self.id_from, self.marker) if one is not None}
