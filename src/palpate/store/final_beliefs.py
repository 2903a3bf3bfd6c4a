"""What explorations of an object ended up believing, for somebody who may see them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import select

from palpate.store import schema
from palpate.store.legible import legible, reading
from palpate.store.records import ThingRef
from palpate.store.rows import moment_at
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_things import rows_of

__all__ = ["FinalBelief", "final_beliefs"]


@dataclass(frozen=True)
class FinalBelief:
    """The belief after the last action of an exploration: property to what stands in its log."""

    episode: UUID
    started_at: datetime
    actions: int
    belief: Mapping[str, Mapping[str, Any]]


def final_beliefs(store: Store, viewer: Viewer, thing: ThingRef, *, limit: int = 12) -> tuple[FinalBelief, ...]:
    """Of the last explorations of an object and of those merged into it, the last one first.

    Only the line of the last action is read, as a log may be long. Explorations that tell no belief are left out.
    """
    episodes, steps = schema.episodes, schema.episode_steps.c
    # steps are counted from 0, and only what says why it stopped follows the last action
    last = steps.position == episodes.c.actions - 1
    asked = (
        select(episodes.c.uuid, episodes.c.started_us, episodes.c.actions, steps.document)
        .join(schema.episode_steps, steps.episode_id == episodes.c.id)
        .where(episodes.c.thing_id.in_(rows_of(thing)), viewer.of(episodes), last)
        .order_by(episodes.c.started_us.desc(), episodes.c.id.desc())
        .limit(limit)
    )
    with reading(store.engine) as connection:
        rows = connection.execute(asked).all()
    found = []
    for row in rows:
        key = UUID(bytes=row.uuid)
        with legible(f"episode {key}"):
            told = json.loads(row.document)["record"].get("belief")
            started_at = moment_at(row.started_us)
        if isinstance(told, dict):
            belief = {name: one for name, one in told.items() if isinstance(one, dict)}
            found.append(FinalBelief(key, started_at, row.actions, belief))
    return tuple(found)
