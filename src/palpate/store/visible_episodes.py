"""Explorations that somebody may see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from uuid import UUID

from sqlalchemy import func, or_, select

from palpate.store import schema
from palpate.store.filters import digest_bytes
from palpate.store.legible import reading
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_words import seen_refs

__all__ = [
    "Progress",
    "episode_is_of",
    "episode_is_there",
    "episode_is_visible",
    "episode_thing",
    "progress_of",
    "recordings_of_digests",
]


@dataclass(frozen=True)
class Progress:
    """How far an exploration is: lines of its log after the first, and why it stopped; None where it did not."""

    lines: int
    stop: str | None


def episode_is_there(store: Store, key: UUID) -> bool:
    """Whether there is an exploration of this id, seen or not."""
    with reading(store.engine) as connection:
        return connection.scalar(select(schema.episodes.c.id).where(schema.episodes.c.uuid == key.bytes)) is not None


def episode_is_of(store: Store, account: str, key: UUID) -> bool:
    """Whether an account owns an exploration or has sent it."""
    columns = schema.episodes.c
    theirs = or_(columns.owner == account, columns.uploaded_by == account)
    with reading(store.engine) as connection:
        return connection.scalar(select(columns.id).where(columns.uuid == key.bytes, theirs)) is not None


def episode_thing(store: Store, viewer: Viewer, thing: ThingRef) -> ThingRef:
    """The object of an exploration, with what a viewer may know of it."""
    columns = schema.things.c
    with reading(store.engine) as connection:
        row = connection.scalar(select(columns.id).where(columns.dataset == thing.dataset, columns.name == thing.id))
        return thing if row is None else seen_refs(connection, viewer, {row: thing})[row]


def episode_is_visible(store: Store, viewer: Viewer, key: UUID) -> bool:
    """Whether there is an exploration of this id to see."""
    episodes = schema.episodes
    asked = select(episodes.c.id).where(episodes.c.uuid == key.bytes, viewer.of(episodes))
    with reading(store.engine) as connection:
        return connection.scalar(asked) is not None


def recordings_of_digests(store: Store, viewer: Viewer, digests: Sequence[str]) -> Mapping[str, UUID]:
    """Ids of those recordings that are seen, by digest."""
    recordings = schema.recordings
    asked = select(recordings.c.digest, recordings.c.uuid).where(
        recordings.c.digest.in_([digest_bytes(digest) for digest in digests]), viewer.of(recordings)
    )
    with reading(store.engine) as connection:
        return {digest.hex(): UUID(bytes=uuid) for digest, uuid in connection.execute(asked)}


def progress_of(store: Store, viewer: Viewer, key: UUID) -> Progress | None:
    """How far an exploration is, or None where there is none to see; quick, as it is asked again and again."""
    episodes, steps = schema.episodes, schema.episode_steps.c
    lines = select(func.count()).where(steps.episode_id == episodes.c.id).scalar_subquery()
    asked = select(lines, episodes.c.stop).where(episodes.c.uuid == key.bytes, viewer.of(episodes))
    with reading(store.engine) as connection:
        row = connection.execute(asked).first()
    return None if row is None else Progress(row[0], row[1])
