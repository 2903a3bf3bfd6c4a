"""Which recordings an export takes, read in parts that fit into memory."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime
from functools import lru_cache
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Select, exists, func, select

from palpate.store import schema
from palpate.store.decoding import moment_from, recording_from, setup_from
from palpate.store.fetching import fetch
from palpate.store.filters import Filter, Sort
from palpate.store.listing import matching
from palpate.store.records import Recording, Setup, ThingRef
from palpate.store.registry import thing_of
from palpate.store.store import Store

__all__ = ["Outline", "Selection"]

AT_ONCE = 200
AS_THEY_CAME = Sort("uploaded", descending=False)


@dataclass(frozen=True)
class Outline:
    """A recording without its arrays and files.

    Attributes
    ----------
    id, digest, visibility
        As of the recording.
    thing, setup
        The object and the devices.
    document
        What was hashed, see `palpate.store.content.document`.
    """

    id: UUID
    digest: bytes
    visibility: str
    thing: ThingRef
    setup: Setup
    document: Mapping[str, Any]

    @property
    def recorded_at(self) -> datetime:
        """When it was recorded."""
        return moment_from(self.document["recorded_at"])


@dataclass(frozen=True)
class Selection:
    """The recordings that match, of those that were there when it was made: it gives the same ones each time.

    Attributes
    ----------
    store
        Where they are.
    wanted
        Conditions that hold for them.
    last
        The row number of the last recording that counts.
    """

    store: Store
    wanted: Filter
    last: int

    @classmethod
    def of(cls, store: Store, wanted: Filter | None = None) -> Selection:
        """All recordings that match now."""
        with store.engine.connect() as connection:
            last = connection.scalar(select(func.max(schema.recordings.c.id)))
        return cls(store, wanted or Filter(), last or 0)

    @property
    def is_all(self) -> bool:
        """Whether nothing was asked for, so that it is all that there is."""
        return self.wanted == Filter()

    def public(self) -> Selection:
        """Those of them that anybody may see."""
        return replace(self, wanted=replace(self.wanted, visibility="public"))

    def count(self) -> int:
        """How many they are."""
        found = self._asked(0, None).order_by(None).subquery()
        with self.store.engine.connect() as connection:
            return connection.scalar(select(func.count()).select_from(found)) or 0

    def outlines(self) -> Iterator[Outline]:
        """Each of them without its arrays and files, in the order in which they came."""
        with self.store.engine.connect() as connection:
            for ids in self._pages(connection):
                for row in connection.execute(_outlines(ids)).mappings():
                    yield _outline(row)

    def batches(self) -> Iterator[list[Recording]]:
        """All of them, verified, some at a time, in the order in which they came.

        What may be large, because it has files or long series, comes by itself, so that memory is bounded by the
        largest recording.

        Raises
        ------
        DamagedError
            If one is not what was put into the store.
        """
        with self.store.engine.connect() as connection:
            for ids in self._pages(connection):
                for part in _parts(ids, set(connection.scalars(_large(ids)))):
                    found = fetch(connection, self.store.blobs, schema.recordings.c.id.in_(part))
                    yield [recording_from(stored) for stored in found]

    def _pages(self, connection: Connection) -> Iterator[list[int]]:
        after = 0
        while ids := list(connection.scalars(self._asked(after, AT_ONCE))):
            yield ids
            after = ids[-1]

    def _asked(self, after: int, limit: int | None) -> Select[*tuple[Any, ...]]:
        row = schema.recordings.c.id
        return matching(self.wanted, AS_THEY_CAME, None, limit).where(row > after, row <= self.last)


def _parts(ids: Sequence[int], large: set[int]) -> Iterator[list[int]]:
    """The same rows in order, those that may be large one by one."""
    part: list[int] = []
    for row in ids:
        if row not in large:
            part.append(row)
            continue
        if part:
            yield part
        yield [row]
        part = []
    if part:
        yield part


def _large(ids: Sequence[int]) -> Select[int]:
    recordings, series, files = schema.recordings.c, schema.series.c, schema.files.c
    long = exists().where(series.recording_id == recordings.id, series.blob.is_not(None))
    filed = exists().where(files.recording_id == recordings.id)
    return select(recordings.id).where(recordings.id.in_(ids), recordings.log_blob.is_not(None) | long | filed)


def _outlines(ids: Sequence[int]) -> Select[*tuple[Any, ...]]:
    recordings, things, setups = schema.recordings, schema.things, schema.setups
    columns = [recordings.c[name] for name in ("uuid", "digest", "visibility", "document")]
    return (
        select(*columns, things, setups.c.document.label("setup"))
        .join(things, recordings.c.thing_id == things.c.id)
        .join(setups, recordings.c.setup_id == setups.c.id)
        .where(recordings.c.id.in_(ids))
        .order_by(recordings.c.id)
    )


def _outline(row: Mapping[Any, Any]) -> Outline:
    return Outline(
        id=UUID(bytes=row["uuid"]),
        digest=row["digest"],
        visibility=row["visibility"],
        thing=thing_of({column.name: row[column] for column in schema.things.c}),
        setup=_setup(row["setup"]),
        document=json.loads(row["document"]),
    )


@lru_cache(maxsize=256)
def _setup(document: str) -> Setup:
    return setup_from(json.loads(document))
