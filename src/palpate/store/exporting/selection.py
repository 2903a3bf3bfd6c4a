"""Which recordings an export takes, read in parts that fit into memory."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime
from functools import lru_cache
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Select, exists, func, select

from palpate.store import schema
from palpate.store.database import snapshot
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
    """The recordings that match, in a store as it was when the selection was made: it gives the same ones each time.

    Attributes
    ----------
    store
        Where they are.
    connection
        Sees the store as it was, for all that shall fit to the recordings.
    wanted
        Conditions that hold for them.
    """

    store: Store
    connection: Connection
    wanted: Filter

    @classmethod
    @contextmanager
    def of(cls, store: Store, wanted: Filter | None = None) -> Iterator[Selection]:
        """All recordings that match now; what is written until the end of the block does not count."""
        with snapshot(store.engine) as connection:
            # the first look is now
            connection.execute(select(func.max(schema.recordings.c.id)))
            yield cls(store, connection, wanted or Filter())

    @property
    def is_all(self) -> bool:
        """Whether nothing was asked for, so that it is all that there is."""
        return self.wanted == Filter()

    def public(self) -> Selection:
        """Those of them that anybody may see."""
        return replace(self, wanted=replace(self.wanted, visibility="public"))

    def count(self) -> int:
        """How many they are."""
        return self.connection.scalar(select(func.count()).select_from(self.rows().subquery())) or 0

    def rows(self) -> Select[int]:
        """Their row numbers, for a larger question to the same connection."""
        return select(matching(self.wanted, AS_THEY_CAME, None, None).order_by(None).subquery().c.id)

    def outlines(self) -> Iterator[Outline]:
        """Each of them without its arrays and files, in the order in which they came."""
        for ids in self._pages():
            for row in self.connection.execute(_outlines(ids)).mappings():
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
        for ids in self._pages():
            for part in _parts(ids, set(self.connection.scalars(_large(ids)))):
                found = fetch(self.connection, self.store.blobs, schema.recordings.c.id.in_(part))
                yield [recording_from(stored) for stored in found]

    def _pages(self) -> Iterator[list[int]]:
        after, row = 0, schema.recordings.c.id
        while ids := list(
            self.connection.scalars(matching(self.wanted, AS_THEY_CAME, None, AT_ONCE).where(row > after))
        ):
            yield ids
            after = ids[-1]


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
