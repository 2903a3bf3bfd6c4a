"""How much there is to see in a store."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import exists, func, select

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_things import count_things

__all__ = ["Counts", "counted"]


@dataclass(frozen=True)
class Counts:
    """Numbers of what somebody sees."""

    recordings: int
    objects: int
    grippers: int
    episodes: int


def counted(store: Store, viewer: Viewer) -> Counts:
    """Count what somebody sees."""
    recordings, episodes, setups = schema.recordings, schema.episodes, schema.setups.c
    # there are few setups, and each has its recordings together
    is_seen = exists().where(recordings.c.setup_id == setups.id, viewer.of(recordings))
    asked = (
        select(func.count()).select_from(recordings).where(viewer.of(recordings)),
        select(func.count(setups.gripper.distinct())).where(is_seen),
        select(func.count()).select_from(episodes).where(viewer.of(episodes)),
    )
    with reading(store.engine) as connection:
        found = [connection.scalar(one) or 0 for one in asked]
    return Counts(found[0], count_things(store, viewer), found[1], found[2])
