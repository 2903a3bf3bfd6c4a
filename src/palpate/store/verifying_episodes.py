"""Whether the episodes and the descriptions of objects in a store are whole."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, select, update

from palpate.store import schema
from palpate.store.database import writing
from palpate.store.decoding import entry_from
from palpate.store.entries import Distribution
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import DamagedError
from palpate.store.keeping_episodes import (
    Row,
    documents_of,
    episode_rows,
    get_episode,
    head_columns,
    next_ids,
    recordings_of,
    stored_episode,
)
from palpate.store.rows import most_probable
from palpate.store.store import Store

__all__ = ["episode_faults", "known_faults", "mend_episode"]


def episode_faults(connection: Connection) -> Iterator[tuple[str, str, bool]]:
    """Episodes that are not what was put: where, what was found, and whether it can be made again."""
    columns, last = schema.episodes.c, 0
    while rows := episode_rows(connection, columns.id.in_(next_ids(connection, last))):
        for row in rows:
            yield from _faults(connection, row)
        last = rows[-1]["id"]


def known_faults(connection: Connection) -> Iterator[tuple[str, str, bool]]:
    """What is known of objects and cannot be read, or is found under another label."""
    known, things = schema.thing_properties, schema.things
    asked = select(known, things.c.dataset, things.c.name).join(things, things.c.id == known.c.thing_id)
    for row in connection.execute(asked.order_by(known.c.id)).mappings():
        where = f"object {row['dataset']}/{row['name']}"
        try:
            entry = entry_from(json.loads(row["document"]))
        except (ValueError, TypeError, KeyError) as error:
            yield where, f"what is known of its {row['property']} cannot be read ({error})", False
            continue
        label = most_probable(entry.probabilities) if isinstance(entry, Distribution) else None
        if (entry.property, label) != (row["property"], row["label"]):
            yield where, f"what is known of its {row['property']} is found under another label", False


def mend_episode(store: Store, key: UUID) -> None:
    """Make the columns and links of an episode again from its content."""
    episode, columns = get_episode(store, key), schema.episodes.c
    with writing(store.engine).begin() as connection:
        row = connection.execute(select(columns.id).where(columns.uuid == key.bytes)).scalar_one()
        connection.execute(update(schema.episodes).where(columns.id == row).values(**head_columns(episode)))
        links, steps = recordings_of(connection, episode), schema.episode_steps
        for place, step in enumerate(episode.steps):
            here = (steps.c.episode_id == row) & (steps.c.position == place)
            link = links.get(step.recording or "")
            connection.execute(update(steps).where(here).values(recording_id=link))


def _faults(connection: Connection, row: Row) -> Iterator[tuple[str, str, bool]]:
    where = f"episode {UUID(bytes=row['uuid'])}"
    try:
        episode = stored_episode(row, documents_of(connection, row["id"]))
    except (DamagedError, ValueError, TypeError, KeyError) as error:
        yield where, str(error), False
        return
    if episode.document != row["document"]:
        yield where, "is of another object than its content says", False
        return
    links = recordings_of(connection, episode)
    for place, step in enumerate(episode.steps):
        if step.recording is not None and step.recording not in links:
            yield where, f"the recording {step.recording} of step {place + 1} is not in the store", False
    if _columns(connection, row) != _columns_wanted(episode, links):
        yield where, "rows for queries are not those of its content", True


def _columns(connection: Connection, row: Row) -> Any:
    steps = schema.episode_steps.c
    asked = select(steps.recording_id).where(steps.episode_id == row["id"]).order_by(steps.position)
    names = ("started_us", "owner", "actions", "stop")
    return [row[name] for name in names], list(connection.scalars(asked))


def _columns_wanted(episode: StoredEpisode, links: Any) -> Any:
    head = head_columns(episode)
    names = ("started_us", "owner", "actions", "stop")
    return [head[name] for name in names], [links.get(step.recording or "") for step in episode.steps]
