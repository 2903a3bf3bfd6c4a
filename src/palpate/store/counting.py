"""How much there is to see in a store."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import func, select

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_setups import seen_grippers
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
    tables = (schema.recordings, schema.episodes)
    asked = [select(func.count()).select_from(table).where(viewer.of(table)) for table in tables]
    with reading(store.engine) as connection:
        recordings, episodes = (connection.scalar(one) or 0 for one in asked)
    return Counts(recordings, count_things(store, viewer), len(seen_grippers(store, viewer)), episodes)
