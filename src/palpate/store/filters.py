"""Which recordings are asked for, and how a list of them is sorted and paged."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime

from sqlalchemy import ColumnElement, Select, func, or_, select, union

from palpate.errors import choices
from palpate.store import schema
from palpate.store.embargo import is_seen_as
from palpate.store.errors import StoreError
from palpate.store.json_columns import HoldsText
from palpate.store.registry import now_us
from palpate.store.rows import microseconds
from palpate.store.search_words import search_words

__all__ = ["Filter", "Labels", "Sort", "each_label"]

Labels = Mapping[str, str | Sequence[str]]
"""A label for each property, or several that all hold."""
SORTS = ("recorded", "uploaded", "action")


@dataclass(frozen=True)
class Filter:
    """Conditions that all hold; what is None is not asked.

    Attributes
    ----------
    thing
        Object: its name in its dataset, its common name, an alias, or ``DATASET/NAME``; objects merged into it count.
    dataset, action, owner
        As recorded.
    property
        What a recording has an entry of.
    labels
        For categorical properties the most probable label that was measured, as ``{"material": "wood"}``.
    known
        What the object is known to be, as ``{"category": "mug"}``: by its description, or by a recording that is
        ground truth. Several labels of one property all hold: ``{"material": ["wood", "metal"]}``, here as in `labels`.
    device
        Name of any device of the setup.
    gripper
        Name of the gripper.
    setup
        Digest of the setup.
    since, until
        When recorded, from the first to before the second.
    ground_truth
        Whether the results are known to be true.
    text
        Words, each a part of names, notices or owner, in any order and any case.
    visibility
        Who may see it now: private, lab or public; until its embargo ends a recording is private.
    """

    thing: str | None = None
    dataset: str | None = None
    action: str | None = None
    owner: str | None = None
    property: str | None = None
    labels: Labels = field(default_factory=dict)
    known: Labels = field(default_factory=dict)
    device: str | None = None
    gripper: str | None = None
    setup: str | None = None
    since: datetime | None = None
    until: datetime | None = None
    ground_truth: bool | None = None
    text: str | None = None
    visibility: str | None = None

    def conditions(self) -> Iterator[ColumnElement[bool]]:
        """All but property and labels, on `schema.recordings`."""
        columns = schema.recordings.c
        for name in ("action", "owner", "gripper", "ground_truth"):
            if getattr(self, name) is not None:
                yield columns[name] == getattr(self, name)
        if self.visibility is not None:
            yield is_seen_as(schema.recordings, self.visibility, now_us())
        if self.thing is not None or self.dataset is not None:
            yield columns.thing_id.in_(things_named(self.thing, self.dataset))
        for name, label in each_label(self.known):
            yield columns.thing_id.in_(things_known(name, label))
        if self.device is not None:
            yield columns.setup_id.in_(_setups_with(self.device))
        if self.setup is not None:
            yield columns.setup_id.in_(
                select(schema.setups.c.id).where(schema.setups.c.digest == digest_bytes(self.setup))
            )
        if self.since is not None:
            yield columns.recorded_us >= moment_us("since", self.since)
        if self.until is not None:
            yield columns.recorded_us < moment_us("until", self.until)
        for word in search_words(self.text or ""):
            yield columns.words.contains(word.casefold(), autoescape=True)

    def entry_conditions(self) -> list[tuple[str, str | None]]:
        """Properties, with the label where one is asked for."""
        found: list[tuple[str, str | None]] = list(each_label(self.labels))
        if self.property is not None and self.property not in self.labels:
            found.append((self.property, None))
        return found


def each_label(labels: Labels) -> Iterator[tuple[str, str]]:
    """Properties and labels in pairs.

    Examples
    --------
    >>> list(each_label({"category": "mug", "material": ["wood", "metal"]}))
    [('category', 'mug'), ('material', 'wood'), ('material', 'metal')]
    """
    for name, some in labels.items():
        yield from ((name, label) for label in ([some] if isinstance(some, str) else some))


@dataclass(frozen=True)
class Sort:
    """By what a list is sorted: ``recorded`` (when), ``uploaded`` (when) or ``action``; the last first by default."""

    by: str = "recorded"
    descending: bool = True

    def __post_init__(self) -> None:
        if self.by not in SORTS:
            raise StoreError(f"sort: found {self.by!r}; {choices(SORTS)}")

    @property
    def column(self) -> str:
        """The column of `schema.recordings`."""
        # rows are numbered as they come
        return {"recorded": "recorded_us", "uploaded": "id"}.get(self.by, self.by)


def things_named(
    name: str | None, dataset: str | None, known: Callable[[str], ColumnElement[bool]] | None = None
) -> Select[tuple[int]]:
    """Rows of objects by name and dataset, with those merged into them; `known`: that one is known by a name."""
    things = schema.things
    asked = select(things.c.id)
    if dataset is not None:
        asked = asked.where(things.c.dataset == dataset)
    if name is not None:
        asked = asked.where(called(name) if known is None else known(name))
    return select(things.c.id).where(or_(things.c.id.in_(asked), things.c.merged_into.in_(asked)))


def called(name: str) -> ColumnElement[bool]:
    """The condition on `schema.things` that one is called so: in its dataset, in common, by alias or by its path."""
    columns = schema.things.c
    path = columns.dataset + "/" + columns.name
    return or_(columns.name == name, columns.common_name == name, HoldsText(columns.aliases, name), path == name)


def things_known(name: str, label: str) -> Select[tuple[int]]:
    """Rows of objects of which a label is known, with those that count as the same object.

    It is known by what was said of the object, or by a recording that is ground truth.
    """
    said, things = schema.thing_properties.c, schema.things
    entries, recordings = schema.entries.c, schema.recordings.c
    found = union(
        select(said.thing_id).where(said.property == name, said.label == label),
        select(entries.thing_id)
        .join(schema.recordings, recordings.id == entries.recording_id)
        .where(entries.property == name, entries.label == label, recordings.ground_truth),
    ).subquery()
    head = func.coalesce(things.c.merged_into, things.c.id)
    heads = select(head).where(things.c.id.in_(select(found.c.thing_id)))
    return select(things.c.id).where(head.in_(heads))


def digest_bytes(text: str) -> bytes:
    """A digest as it stands in the tables.

    Raises
    ------
    StoreError
        If it is none.
    """
    try:
        digest = bytes.fromhex(text)
    except ValueError:
        digest = b""
    if len(digest) != 32:
        raise StoreError(f"digest: found {text!r}, expected 64 hexadecimal digits")
    return digest


def _setups_with(device: str) -> Select[tuple[int]]:
    links, devices = schema.setup_devices.c, schema.devices.c
    return select(links.setup_id).join(schema.devices, links.device_id == devices.id).where(devices.name == device)


def moment_us(name: str, moment: datetime) -> int:
    """A moment as it stands in the tables; StoreError where it has no time zone."""
    if moment.utcoffset() is None:
        raise StoreError(f"{name}: {moment.isoformat()} has no time zone; expected one, such as UTC")
    return microseconds(moment)
