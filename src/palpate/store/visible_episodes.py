"""Explorations that somebody may see."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from uuid import UUID

from sqlalchemy import select

from palpate.store import schema
from palpate.store.filters import digest_bytes
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["episode_is_visible", "recordings_of_digests"]


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
