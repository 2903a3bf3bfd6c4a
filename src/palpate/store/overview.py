"""What is in a store, in short."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import Column, Select, func, select

from palpate.store import schema
from palpate.store.fetching import setup_of
from palpate.store.legible import reading
from palpate.store.records import Setup, ThingRef
from palpate.store.registry import thing_of
from palpate.store.store import Store

__all__ = ["Contents", "contents"]


@dataclass(frozen=True)
class Contents:
    """How many recordings there are, of which objects and with which setups, the most frequent first; and episodes."""

    recordings: int
    things: tuple[tuple[ThingRef, int], ...]
    setups: tuple[tuple[Setup, int], ...]
    episodes: int = 0


def contents(store: Store) -> Contents:
    """Count what is in a store; recordings of an object merged into another count as that one's."""
    columns = schema.recordings.c
    with reading(store.engine) as connection:
        of_things = dict(connection.execute(_counts(columns.thing_id)).all())
        of_setups = dict(connection.execute(_counts(columns.setup_id)).all())
        things = {row["id"]: row for row in connection.execute(select(schema.things)).mappings()}
        setups = {row.id: row for row in connection.execute(select(schema.setups))}
        episodes = connection.scalar(select(func.count()).select_from(schema.episodes))
        heads: dict[int, int] = {}
        for thing, count in of_things.items():
            head = things[thing]["merged_into"] or thing
            heads[head] = heads.get(head, 0) + count
        return Contents(
            sum(of_things.values()),
            tuple((thing_of(things[head]), count) for head, count in _ranked(heads)),
            tuple(
                (setup_of(setups[setup].digest, setups[setup].document), count) for setup, count in _ranked(of_setups)
            ),
            episodes or 0,
        )


def _counts(column: Column[int]) -> Select[int, int]:
    return select(column, func.count()).group_by(column)


def _ranked(counts: Mapping[int, int]) -> list[tuple[int, int]]:
    return sorted(counts.items(), key=lambda item: (-item[1], item[0]))
