"""How much there is to see in a store."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import func, select

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_setups import gripper_names
from palpate.store.visible_things import ThingFilter, listed_things

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
    recordings, episodes = (
        select(table.c.id).where(viewer.of(table)) for table in (schema.recordings, schema.episodes)
    )
    seen = (recordings, listed_things(viewer, ThingFilter()), gripper_names(viewer), episodes)
    numbers = (select(func.count()).select_from(one.subquery()).scalar_subquery() for one in seen)
    with reading(store.engine) as connection:
        return Counts(*connection.execute(select(*numbers)).one())
