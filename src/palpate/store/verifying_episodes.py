"""Whether the episodes and the descriptions of objects in a store are whole."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, select, update

from palpate.store import schema
from palpate.store.database import changing
from palpate.store.entries import Distribution
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import DamagedError, IncompleteError
from palpate.store.faults import Fault, Remedy
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
from palpate.store.known_units import is_known_unit
from palpate.store.legible import legible
from palpate.store.registry import thing_of
from palpate.store.rows import most_probable
from palpate.store.store import Store
from palpate.store.things import known_of

__all__ = ["episode_faults", "known_faults", "mend_episode"]


def episode_faults(connection: Connection) -> Iterator[Fault]:
    """Episodes that are not what was put."""
    last = 0
    while ids := next_ids(connection, last):
        for row in ids:
            yield from _episode_faults(connection, row)
        last = ids[-1]


def known_faults(connection: Connection) -> Iterator[Fault]:
    """Descriptions of objects, and what is known of them, that cannot be read; or that is found under another label."""
    things, known = schema.things, schema.thing_properties
    for thing in list(connection.scalars(select(things.c.id).order_by(things.c.id))):
        where = f"object of row {thing}"
        try:
            row = connection.execute(select(things).where(things.c.id == thing)).mappings().one()
            where = f"object {row['dataset']}/{row['name']}"
            thing_of(row)
            for each in connection.execute(
                select(known).where(known.c.thing_id == thing).order_by(known.c.id)
            ).mappings():
                entry = known_of(each, row).entry
                label = most_probable(entry.probabilities) if isinstance(entry, Distribution) else None
                if (entry.property, label) != (each["property"], each["label"]):
                    yield Fault(where, f"what is known of its {each['property']} is found under another label")
                unit = getattr(entry, "unit", None)
                if unit is not None and not is_known_unit(unit):
                    yield Fault(where, f"what is known of its {each['property']} is in {unit!r}, which is no unit here")
        except IncompleteError:
            raise
        except DamagedError as error:
            yield Fault(where, str(error).removeprefix(f"{where}: "))


def mend_episode(store: Store, key: UUID) -> None:
    """Make the columns and links of an episode again from its content."""
    episode, columns = get_episode(store, key), schema.episodes.c
    with changing(store.engine) as connection:
        row = connection.execute(select(columns.id).where(columns.uuid == key.bytes)).scalar_one()
        connection.execute(update(schema.episodes).where(columns.id == row).values(**head_columns(episode)))
        links, steps = recordings_of(connection, episode), schema.episode_steps
        for place, step in enumerate(episode.steps):
            here = (steps.c.episode_id == row) & (steps.c.position == place)
            link = links.get(step.recording or "")
            connection.execute(update(steps).where(here).values(recording_id=link))


def _episode_faults(connection: Connection, key: int) -> Iterator[Fault]:
    where = f"episode of row {key}"
    try:
        with legible(where):
            rows = episode_rows(connection, schema.episodes.c.id == key)
            if not rows:
                raise DamagedError(f"{where}: refers to an object that is missing")
            where = f"episode {UUID(bytes=rows[0]['uuid'])}"
            episode = stored_episode(rows[0], documents_of(connection, key))
            if episode.document != rows[0]["document"]:
                raise DamagedError(f"{where}: is of another object than its content says")
    except IncompleteError:
        raise
    except DamagedError as error:
        yield Fault(where, str(error).removeprefix(f"{where}: "))
        return
    yield from _link_faults(connection, rows[0], episode, where)


def _link_faults(connection: Connection, row: Row, episode: StoredEpisode, where: str) -> Iterator[Fault]:
    links = recordings_of(connection, episode)
    for place, step in enumerate(episode.steps):
        if step.recording is not None and step.recording not in links:
            yield Fault(where, f"the recording {step.recording} of step {place + 1} is not in the store")
    if _columns(connection, row) != _columns_wanted(episode, links):
        yield Fault(where, "rows for queries are not those of its content", Remedy.REINDEX)


def _columns(connection: Connection, row: Row) -> Any:
    steps = schema.episode_steps.c
    asked = select(steps.recording_id).where(steps.episode_id == row["id"]).order_by(steps.position)
    names = ("started_us", "owner", "actions", "stop")
    return [row[name] for name in names], list(connection.scalars(asked))


def _columns_wanted(episode: StoredEpisode, links: Any) -> Any:
    head = head_columns(episode)
    names = ("started_us", "owner", "actions", "stop")
    return [head[name] for name in names], [links.get(step.recording or "") for step in episode.steps]
