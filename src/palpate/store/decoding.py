"""Recordings from what was stored of them: the reverse of `palpate.store.content`."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from uuid import UUID

from palpate.store.content import KINDS, channel_arrays, digest_of
from palpate.store.entries import Entry
from palpate.store.errors import DamagedError
from palpate.store.legible import legible
from palpate.store.records import Device, FileItem, Pose, Recording, Series, Setup, ThingRef

__all__ = ["Stored", "entry_from", "pose_from", "recording_from", "setup_from", "thing_from"]

CLASSES: Mapping[str, Callable[..., Entry]] = {kind: entry for entry, kind in KINDS.items()}


@dataclass(frozen=True)
class Stored:
    """A recording in parts, as a store or an archive holds it."""

    id: UUID
    digest: str
    visibility: str
    document: str
    log: bytes
    thing: ThingRef
    setup: Setup
    series: tuple[Series, ...]
    files: tuple[bytes | Path, ...]
    embargoed_until: datetime | None = None


def recording_from(stored: Stored) -> Recording:
    """Put a recording together and verify its digest.

    Raises
    ------
    DamagedError
        If it is not what was stored under that digest.
    """
    arrays = (array for one in stored.series for channel in one.channels for array in channel_arrays(channel))
    found = digest_of(stored.document.encode(), arrays, stored.log)
    if found != stored.digest:
        raise DamagedError(f"recording {stored.id}: digest {found}, expected {stored.digest}")
    with legible(f"recording {stored.id}"):
        return _put_together(stored)


def _put_together(stored: Stored) -> Recording:
    plain = json.loads(stored.document)
    same = ("action", "owner", "licence", "ground_truth", "software", "repository", "grasp")
    return Recording(
        recorded_at=moment_from(plain["recorded_at"]),
        thing=stored.thing,
        setup=stored.setup,
        visibility=stored.visibility,
        embargoed_until=stored.embargoed_until,
        gripper_pose=pose_from(plain["gripper_pose"]),
        object_pose=pose_from(plain["object_pose"]),
        series=stored.series,
        files=tuple(
            FileItem(item["name"], item["media_type"], data)
            for item, data in zip(plain["files"], stored.files, strict=True)
        ),
        entries=tuple(entry_from(entry) for entry in plain["entries"]),
        log=stored.log.decode(),
        notices=tuple(plain["notices"]),
        id=stored.id,
        **{name: plain[name] for name in same},
    )


def moment_from(text: str) -> datetime:
    """A moment as `palpate.store.content.in_utc` writes it."""
    return datetime.fromisoformat(text.removesuffix("Z")).replace(tzinfo=UTC)


def entry_from(plain: Mapping[str, Any]) -> Entry:
    """An entry as `palpate.store.content.entry_plain` writes it."""
    return CLASSES[plain["kind"]](**{name: value for name, value in plain.items() if name != "kind"})


def setup_from(plain: Mapping[str, Any]) -> Setup:
    """A setup as `palpate.store.content.setup_plain` writes it."""
    named = {name: None if value is None else Device(**value) for name, value in plain.items() if name != "other"}
    return Setup(**named, other=tuple(Device(**device) for device in plain["other"]))


def thing_from(plain: Mapping[str, Any]) -> ThingRef:
    """An object as `palpate.store.content.thing_plain` writes it."""
    return ThingRef(**{**plain, "aliases": tuple(plain["aliases"])})


def pose_from(plain: Mapping[str, Any] | None) -> Pose | None:
    """A pose as `palpate.store.content.pose_plain` writes it; None where there is none."""
    if plain is None:
        return None
    turn = plain["quaternion"]
    return Pose(tuple(plain["translation_m"]), None if turn is None else tuple(turn), plain["frame"], plain["original"])
