"""What is in a store, in short."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from sqlalchemy import Column, Connection, Select, func, select

from palpate.store import schema
from palpate.store.each_thing import each_thing
from palpate.store.errors import DamagedError, IncompleteError
from palpate.store.fetching import setup_of
from palpate.store.legible import reading
from palpate.store.listing import Damaged
from palpate.store.records import Setup, ThingRef
from palpate.store.registry import thing_of
from palpate.store.store import Store

__all__ = ["Contents", "contents"]


@dataclass(frozen=True)
class Contents:
    """How many recordings there are, of which objects and with which setups, the most frequent first; and episodes.

    The recordings of an object that is damaged count, and it is not among the objects.
    """

    recordings: int
    things: tuple[tuple[ThingRef, int], ...]
    setups: tuple[tuple[Setup, int], ...]
    episodes: int = 0


def contents(store: Store, damaged: Damaged | None = None) -> Contents:
    """Count what is in a store; recordings of an object merged into another count as that one's.

    Parameters
    ----------
    store
        What to look into.
    damaged
        Is told of each object that cannot be read; unless given, the first one is raised.

    Raises
    ------
    DamagedError
        If an object or a setup cannot be read.
    """
    columns, things = schema.recordings.c, schema.things.c
    with reading(store.engine) as connection:
        of_things = dict(connection.execute(_counts(columns.thing_id)).all())
        of_setups = dict(connection.execute(_counts(columns.setup_id)).all())
        merged = dict(connection.execute(select(things.id, things.merged_into)).all())
        setups = {row.id: row for row in connection.execute(select(schema.setups))}
        episodes = connection.scalar(select(func.count()).select_from(schema.episodes))
        heads: dict[int, int] = {}
        for thing, count in of_things.items():
            head = merged[thing] or thing
            heads[head] = heads.get(head, 0) + count
        found = _things(connection, heads, damaged)
        return Contents(
            sum(of_things.values()),
            tuple((found[head], count) for head, count in _ranked(heads) if head in found),
            tuple(
                (setup_of(setups[setup].digest, setups[setup].document), count) for setup, count in _ranked(of_setups)
            ),
            episodes or 0,
        )


def _things(connection: Connection, heads: Collection[int], damaged: Damaged | None) -> Mapping[int, ThingRef]:
    things = schema.things
    try:
        rows = connection.execute(select(things)).mappings()
        return {row["id"]: thing_of(row) for row in rows if row["id"] in heads}
    except IncompleteError:
        raise
    except DamagedError:
        if damaged is None:
            raise

    def read(row: int) -> ThingRef:
        return thing_of(connection.execute(select(things).where(things.c.id == row)).mappings().one())

    return dict(each_thing(connection, heads, read, damaged))


def _counts(column: Column[int]) -> Select[int, int]:
    return select(column, func.count()).group_by(column)


def _ranked(counts: Mapping[int, int]) -> list[tuple[int, int]]:
    return sorted(counts.items(), key=lambda item: (-item[1], item[0]))
