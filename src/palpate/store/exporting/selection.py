"""Which recordings an export takes, read in parts that fit into memory."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from datetime import datetime
from functools import cached_property
from typing import Any
from uuid import UUID

from sqlalchemy import Connection, Select, exists, func, select

from palpate.store import schema
from palpate.store.database import snapshot
from palpate.store.decoding import moment_from
from palpate.store.embargo import embargo_of
from palpate.store.errors import DamagedError
from palpate.store.fetching import Broken, read_each, setup_of
from palpate.store.filters import Filter, Sort
from palpate.store.matching import matching
from palpate.store.records import Recording, Setup, ThingRef, visibility_now
from palpate.store.registry import thing_of
from palpate.store.seals import sealed_document
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_words import rows_named, seen_refs

__all__ = ["Outline", "Selection"]

AT_ONCE = 200
AS_THEY_CAME = Sort("uploaded", descending=False)


@dataclass(frozen=True)
class Outline:
    """A recording without its arrays and files.

    Attributes
    ----------
    id, digest
        As of the recording.
    visibility
        Who may see it now.
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
    without
        Row numbers of recordings that are left out although they match.
    forgiving
        Whether damaged pictures of objects are left out too.
    """

    store: Store
    connection: Connection
    wanted: Filter
    without: frozenset[int] = frozenset()
    forgiving: bool = False

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
        """Whether nothing was asked for and nothing left out, so that it is all that there is."""
        return self.wanted == Filter() and not self.without

    def public(self) -> Selection:
        """Those of them that anybody may see."""
        return replace(self, wanted=replace(self.wanted, visibility="public"))

    @cached_property
    def viewer(self) -> Viewer:
        """Somebody who sees as much as those to whom recordings of one visibility may be given."""
        return {"public": Viewer(), "lab": Viewer(lab=True)}.get(self.wanted.visibility or "", Viewer(everything=True))

    def count(self) -> int:
        """How many they are."""
        return self.connection.scalar(select(func.count()).select_from(self.rows().subquery())) or 0

    def rows(self) -> Select[int]:
        """Their row numbers, for a larger question to the same connection."""
        return select(self._asked(None).order_by(None).subquery().c.id)

    def outlines(self) -> Iterator[Outline]:
        """Each of them without its arrays and files, in the order in which they came."""
        for ids in self._pages():
            found = [_outline(row) for row in self.connection.execute(_outlines(ids)).mappings()]
            seen = self._seen([one.thing for one in found])
            yield from (replace(one, thing=seen[one.thing.dataset, one.thing.id]) for one in found)

    def batches(self) -> Iterator[list[Recording]]:
        """All of them, verified, some at a time, in the order in which they came.

        What may be large, because it has files or long series, comes by itself, so that memory is bounded by the
        largest recording.

        Raises
        ------
        DamagedError
            If one is not what was put into the store.
        """
        return (self._shown([_sound(one) for one in found]) for found in self._read())

    def damaged(self) -> list[Broken]:
        """Those that are not what was put into the store; this reads all of them."""
        return [one for found in self._read() for one in found if isinstance(one, Broken)]

    def _shown(self, found: Sequence[Recording]) -> list[Recording]:
        seen = self._seen([one.thing for one in found])
        return [replace(one, thing=seen[one.thing.dataset, one.thing.id]) for one in found]

    def _seen(self, things: Sequence[ThingRef]) -> Mapping[tuple[str, str], ThingRef]:
        """Objects by dataset and name, with what may be told of them."""
        named = {(one.dataset, one.id): one for one in things}
        rows = {} if self.viewer.everything else rows_named(self.connection, list(named))
        seen = seen_refs(self.connection, self.viewer, {row: named[name] for name, row in rows.items()})
        return {**named, **{name: seen[row] for name, row in rows.items()}}

    def _read(self) -> Iterator[Iterator[Recording | Broken]]:
        for ids in self._pages():
            for part in _parts(ids, set(self.connection.scalars(_large(ids)))):
                yield read_each(self.connection, self.store.blobs, part)

    def _pages(self) -> Iterator[list[int]]:
        after, row = 0, schema.recordings.c.id
        while ids := list(self.connection.scalars(self._asked(AT_ONCE).where(row > after))):
            yield ids
            after = ids[-1]

    def _asked(self, limit: int | None) -> Select[*tuple[Any, ...]]:
        asked = matching(self.wanted, AS_THEY_CAME, None, limit)
        return asked.where(schema.recordings.c.id.not_in(self.without)) if self.without else asked


def _sound(found: Recording | Broken) -> Recording:
    if isinstance(found, Broken):
        raise DamagedError(str(found))
    return found


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
    columns = [recordings.c[name] for name in ("uuid", "digest", "visibility", "embargoed_us", "document", "seal")]
    return (
        select(*columns, things, setups.c.digest.label("setup_digest"), setups.c.document.label("setup"))
        .join(things, recordings.c.thing_id == things.c.id)
        .join(setups, recordings.c.setup_id == setups.c.id)
        .where(recordings.c.id.in_(ids))
        .order_by(recordings.c.id)
    )


def _outline(row: Mapping[Any, Any]) -> Outline:
    document = sealed_document(row)
    return Outline(
        id=UUID(bytes=row["uuid"]),
        digest=row["digest"],
        visibility=visibility_now(row["visibility"], embargo_of(row["embargoed_us"])),
        thing=thing_of({column.name: row[column] for column in schema.things.c}),
        setup=setup_of(row["setup_digest"], row["setup"]),
        document=document,
    )
