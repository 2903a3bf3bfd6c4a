"""What a store holds: one measurement with its raw signals, results, object, setup and poses.

Plain frozen values without a database. Whether one may be kept is for `palpate.store.checks`; what makes two of
them the same is for `palpate.store.content`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path
from typing import Any
from uuid import UUID, uuid4

import numpy as np
from numpy.typing import NDArray

from palpate.store.entries import Entry

__all__ = [
    "Channel",
    "Device",
    "FileItem",
    "Pose",
    "Receipt",
    "Recording",
    "Series",
    "Setup",
    "ThingRef",
    "visibility_now",
]

VISIBILITIES = ("private", "lab", "public")
DEVICE_KINDS = ("arm", "gripper", "camera", "microphone", "other")


@dataclass(frozen=True)
class Pose:
    """Where something was.

    Attributes
    ----------
    translation_m
        x, y, z [m].
    quaternion
        w, x, y, z of unit length; None where the rotation cannot be told from what was given.
    frame
        The frame of reference, such as ``"base"``.
    original
        The pose as it was given, in its own words.
    """

    translation_m: tuple[float, float, float]
    quaternion: tuple[float, float, float, float] | None = None
    frame: str = "base"
    original: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Channel:
    """Samples of one quantity.

    Attributes
    ----------
    name
        Unique within its series.
    quantity
        What was measured, such as ``"force"``.
    unit
        As given; None where nobody stated it.
    values
        Numbers, (n, ...): the first axis is time. They may hold NaN where a sample is missing.
    rate_hz
        Samples per second, where they are evenly spaced.
    time_s
        Time stamps [s], (n), where they are not.
    """

    name: str
    quantity: str
    unit: str | None
    values: NDArray[Any]
    rate_hz: float | None = None
    time_s: NDArray[np.float64] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", np.asarray(self.values))
        if self.time_s is not None:
            object.__setattr__(self, "time_s", np.asarray(self.time_s, dtype=np.float64))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Channel):
            return NotImplemented
        named = (self.name, self.quantity, self.unit, self.rate_hz)
        return (
            named == (other.name, other.quantity, other.unit, other.rate_hz)
            and _same(self.values, other.values)
            and _same(self.time_s, other.time_s)
        )

    def __hash__(self) -> int:
        return hash((self.name, self.quantity, self.unit, self.rate_hz, self.values.shape))


def _same(one: NDArray[Any] | None, other: NDArray[Any] | None) -> bool:
    """Whether two arrays hold the same numbers of the same kind, NaN being like NaN."""
    if one is None or other is None:
        return one is other
    return one.dtype == other.dtype and one.shape == other.shape and one.tobytes() == other.tobytes()


@dataclass(frozen=True)
class Series:
    """Channels that one device recorded together; they may have rates of their own."""

    name: str
    channels: tuple[Channel, ...]

    @cached_property
    def layout(self) -> str:
        """What its arrays are, as JSON, without how many samples they have."""
        from palpate.store.content import layout_text

        return layout_text(self)


@dataclass(frozen=True)
class FileItem:
    """An image, a sound, a point cloud or any other file; `data` is what is in it, or the path to read it from."""

    name: str
    media_type: str
    data: bytes | Path

    @cached_property
    def sha256(self) -> str:
        """SHA-256 of what is in the file, in hexadecimal digits."""
        from palpate.store.content import file_digest

        return file_digest(self.data)


@dataclass(frozen=True)
class Device:
    """A device as it was when it measured.

    Attributes
    ----------
    kind
        arm, gripper, camera, microphone or other.
    name, maker
        What it is and who makes it.
    parameters, calibration
        Anything that JSON can hold.
    calibrated_on
        When it was calibrated, as an ISO 8601 date.
    """

    kind: str
    name: str
    maker: str | None = None
    parameters: Mapping[str, Any] = field(default_factory=dict)
    calibration: Mapping[str, Any] = field(default_factory=dict)
    calibrated_on: str | None = None


@dataclass(frozen=True)
class Setup:
    """The devices that measured; two with the same devices are one."""

    arm: Device | None = None
    gripper: Device | None = None
    camera: Device | None = None
    microphone: Device | None = None
    other: tuple[Device, ...] = ()

    @property
    def devices(self) -> tuple[Device, ...]:
        """All devices, arm first."""
        named = (self.arm, self.gripper, self.camera, self.microphone)
        return tuple(device for device in named if device is not None) + self.other

    @cached_property
    def digest(self) -> str:
        """SHA-256 of what the setup is, in hexadecimal digits."""
        from palpate.store.content import setup_digest

        return setup_digest(self)


@dataclass(frozen=True)
class ThingRef:
    """The object that was measured, by its dataset and its name there; the rest describes it.

    The digest of a recording covers dataset and id: a better description does not make another recording.
    """

    dataset: str
    id: str
    maker: str | None = None
    common_name: str | None = None
    attributes: Mapping[str, Any] = field(default_factory=dict)
    aliases: tuple[str, ...] = ()


@dataclass(frozen=True)
class Recording:
    """One measurement with all that belongs to it.

    Attributes
    ----------
    recorded_at
        When, with a time zone.
    action
        What the robot did, as the network calls it.
    thing, setup
        The object and the devices.
    entries
        The results; none for raw signals alone.
    series, files
        The raw signals.
    grasp, gripper_pose, object_pose
        How the object was held and where everything was.
    owner, licence, visibility
        Whose it is and who may see it: private, lab or public.
    ground_truth
        Whether the results are known to be true, as from a scale, and not a robot's.
    software, repository
        Version and address of the program that measured.
    log, notices
        What the program printed, and what was odd.
    embargoed_until
        Until when only those see it who would if it were private; with a time zone.
    id
        Its own, whatever it holds.

    Examples
    --------
    >>> from datetime import UTC
    >>> from palpate.store.entries import Value
    >>> mug = ThingRef("ycb", "025_mug")
    >>> one = Recording(datetime(2024, 5, 1, tzinfo=UTC), "weighing", mug, entries=(Value("mass", 118.0, 6.0, "g"),))
    >>> one.digest[:8]
    'c49f69a2'
    >>> one
    <Recording: 'weighing' of 'ycb/025_mug', 2024-05-01 00:00:00+00:00, 0 series>
    """

    recorded_at: datetime
    action: str
    thing: ThingRef
    setup: Setup = Setup()
    owner: str | None = None
    licence: str | None = None
    visibility: str = "private"
    ground_truth: bool = False
    software: str | None = None
    repository: str | None = None
    grasp: Mapping[str, Any] | None = None
    gripper_pose: Pose | None = None
    object_pose: Pose | None = None
    series: tuple[Series, ...] = ()
    files: tuple[FileItem, ...] = ()
    entries: tuple[Entry, ...] = ()
    log: str = ""
    notices: tuple[str, ...] = ()
    embargoed_until: datetime | None = None
    id: UUID = field(default_factory=uuid4)

    def __repr__(self) -> str:
        # samples, files and a log are no line on a screen
        thing, when = f"{self.thing.dataset}/{self.thing.id}", self.recorded_at.isoformat(" ", "seconds")
        return f"<Recording: {self.action!r} of {thing!r}, {when}, {len(self.series)} series>"

    @cached_property
    def document(self) -> str:
        """All but id, visibility, embargo, arrays, files and log, as JSON: what is hashed and stored."""
        from palpate.store.content import document

        return document(self)

    @cached_property
    def digest(self) -> str:
        """SHA-256 of the content, in hexadecimal digits.

        The id, who may see it, and who sent it when do not count, so that the same measurement sent twice is known
        as one.
        """
        from palpate.store.content import recording_digest

        return recording_digest(self)


def visibility_now(visibility: str, embargoed_until: datetime | None) -> str:
    """Who may see something now: what is embargoed is private until then.

    Examples
    --------
    >>> visibility_now("public", datetime(2999, 1, 1, tzinfo=UTC)), visibility_now("public", None)
    ('private', 'public')
    """
    return visibility if embargoed_until is None or embargoed_until <= datetime.now(UTC) else "private"


@dataclass(frozen=True)
class Receipt:
    """What became of a recording: under which id a store has it, whether it was new, and what cannot be true in it."""

    id: UUID
    digest: str
    new: bool
    notices: tuple[str, ...] = ()
