"""The form of answers, as the OpenAPI document tells it."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any, Generic, Literal, TypeVar
from uuid import UUID

from pydantic import BaseModel, ConfigDict, Field

__all__ = [
    "Batch",
    "Change",
    "Device",
    "Digests",
    "Entry",
    "EntryRow",
    "Episode",
    "EpisodeProgress",
    "EpisodeRow",
    "File",
    "KnownRecordings",
    "Object",
    "Page",
    "Property",
    "Receipt",
    "Recording",
    "RecordingRow",
    "SeriesInfo",
    "SeriesSamples",
    "Setup",
    "Strict",
    "Token",
    "User",
]

Item = TypeVar("Item")
Visibility = Literal["private", "lab", "public"]


class Strict(BaseModel):
    """Holds what it says and nothing else."""

    model_config = ConfigDict(extra="forbid")


class Page(Strict, Generic[Item]):
    """Some items, and the cursor of the next page; null where there is none."""

    items: list[Item]
    next: str | None


class Entry(Strict):
    """A result: a value, a distribution, an interval, a bound, or a failure."""

    kind: Literal["value", "distribution", "interval", "bound", "failed"]
    property: str | None = None
    value: float | None = None
    sd: float | None = None
    unit: str | None = None
    probabilities: dict[str, float] | None = None
    low: float | None = None
    high: float | None = None
    above: float | None = None
    below: float | None = None
    reason: str | None = None


class ThingName(Strict):
    """An object by its dataset and its name there."""

    dataset: str
    name: str


class Known(Strict):
    """What is known of a property of an object, and from where."""

    entry: Entry
    source: str


class Image(Strict):
    """A picture of an object."""

    name: str
    media_type: str
    url: str


class Object(ThingName):
    """An object with what is known of it."""

    common_name: str | None
    maker: str | None
    aliases: list[str]
    attributes: dict[str, Any]
    known: list[Known]
    images: list[Image]
    merged: list[ThingName]
    recordings: int
    url: str


class Device(Strict):
    """A device as it was when it measured."""

    digest: str
    kind: str
    name: str
    maker: str | None
    calibrated_on: str | None
    parameters: dict[str, Any]
    calibration: dict[str, Any]
    setups: list[str]
    recordings: int


class DevicePart(Strict):
    """A device as part of a setup."""

    kind: str
    name: str
    maker: str | None
    calibrated_on: str | None
    parameters: dict[str, Any]
    calibration: dict[str, Any]


class Setup(Strict):
    """Devices that measured together."""

    digest: str
    devices: list[DevicePart]
    recordings: int


class RecordingRow(Strict):
    """A recording as it stands in a list."""

    id: UUID
    digest: str
    recorded_at: datetime
    uploaded_at: datetime
    action: str
    object: ThingName
    common_name: str | None
    gripper: str | None
    owner: str | None
    visibility: Visibility
    embargoed_until: datetime | None
    ground_truth: bool
    entries: list[Entry]
    notices: list[str]
    url: str


class Channel(Strict):
    """Samples of one quantity, without the samples."""

    name: str
    quantity: str
    unit: str | None
    rate_hz: float | None
    timed: bool
    shape: list[int]


class SeriesInfo(Strict):
    """A series without its samples; `position` is its place in the recording."""

    position: int
    name: str
    channels: list[Channel]
    url: str


class ChannelSamples(Channel):
    """Samples of one quantity: values as nested lists, null where a sample is missing."""

    values: list[Any]
    time_s: list[float] | None


class SeriesSamples(Strict):
    """A series with its samples."""

    name: str
    channels: list[ChannelSamples]


class File(Strict):
    """A file of a recording; `position` is its place there."""

    position: int
    name: str
    media_type: str
    sha256: str
    url: str


class Pose(Strict):
    """Where something was."""

    translation_m: list[float]
    quaternion: list[float] | None
    frame: str
    original: dict[str, Any]


class Recording(Strict):
    """A recording whole, but for samples, what is in its files, and its log.

    Who has sent it is told to those with an account.
    """

    id: UUID
    digest: str
    recorded_at: datetime
    uploaded_at: datetime
    action: str
    object: ThingName
    common_name: str | None
    owner: str | None
    uploaded_by: str | None
    licence: str | None
    visibility: Visibility
    embargoed_until: datetime | None
    ground_truth: bool
    software: str | None
    repository: str | None
    setup: str
    grasp: dict[str, Any] | None
    gripper_pose: Pose | None
    object_pose: Pose | None
    entries: list[Entry]
    notices: list[str]
    series: list[SeriesInfo]
    files: list[File]
    url: str


class EntryRow(Strict):
    """A result with what it is of; numbers as they were given and in SI units."""

    recording: UUID
    recorded_at: datetime
    action: str
    object: ThingName
    gripper: str | None
    ground_truth: bool
    label: str | None
    value_si: float | None
    sd_si: float | None
    entry: Entry


class EpisodeRow(Strict):
    """An exploration as it stands in a list; `stop` is null where it was interrupted."""

    id: UUID
    digest: str
    started_at: datetime
    object: ThingName
    common_name: str | None
    owner: str | None
    visibility: Visibility
    embargoed_until: datetime | None
    network: str
    objective: str
    policy: str
    robot: str
    actions: int
    stop: str | None
    url: str


class Step(Strict):
    """A line of an episode's log, with the recording of the action where there is one to see."""

    record: dict[str, Any]
    recording: UUID | None


class Episode(EpisodeRow):
    """An exploration whole."""

    header: dict[str, Any]
    steps: list[Step]


class EpisodeProgress(Strict):
    """How far an exploration is: lines of its log after the first; why it stopped; its page for people."""

    id: UUID
    lines: int
    stop: str | None
    page: str


class Property(Strict):
    """A property with the unit that it was first given in; null where it has labels."""

    name: str
    unit: str | None
    entries: int


class Change(Strict):
    """A change of an object: what was there before and after, and whether it was taken back."""

    at: datetime
    who: str | None
    what: str
    detail: Any
    undone_at: datetime | None
    undone_by: str | None


class Sharing(Strict):
    """Who may see something, and until when nobody else does."""

    visibility: Visibility
    embargoed_until: datetime | None


class SharingChange(Strict):
    """A change of who may see something: what held before and after, and whether it was taken back."""

    at: datetime
    who: str | None
    before: Sharing
    after: Sharing
    undone_at: datetime | None
    undone_by: str | None


class Receipt(Strict):
    """What became of a recording: under which id the store has it, and whether it was new there."""

    id: UUID
    digest: str
    new: bool


class BatchField(Strict):
    """A field that is wrong."""

    field: str
    detail: str


class BatchItem(Strict):
    """What became of one recording of a batch: 201 it is new, 200 it is known, 422 it is refused."""

    source: str
    status: Literal[200, 201, 422]
    id: UUID | None
    digest: str | None
    new: bool
    detail: str | None
    errors: list[BatchField]


class Batch(Strict):
    """What became of each recording of a batch, in the order in which they came."""

    items: list[BatchItem]


class Digests(Strict):
    """Recordings by their digests, SHA-256 in hexadecimal digits."""

    digests: list[Annotated[str, Field(pattern="^[0-9a-f]{64}$")]] = Field(max_length=1_000)


class KnownRecordings(Strict):
    """Those recordings that are here, with their ids."""

    known: dict[str, UUID]


class User(Strict):
    """An account."""

    name: str
    role: str
    email: str | None
    created_at: datetime
    tokens: int


class Token(Strict):
    """A token without its secret."""

    id: int
    user: str
    role: str
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
