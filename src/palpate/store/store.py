"""The store: put recordings in, get them back."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import TracebackType
from typing import Self
from uuid import UUID

from sqlalchemy import Connection, Engine, bindparam, select, text
from sqlalchemy.exc import DatabaseError, IntegrityError

from palpate.store import schema
from palpate.store.blobs import Blobs
from palpate.store.checks import check
from palpate.store.database import writing
from palpate.store.decoding import recording_from
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.fetching import fetch
from palpate.store.inserting import insert_rows
from palpate.store.records import Receipt, Recording
from palpate.store.registry import Lookup, Registry, now_us
from palpate.store.rows import Prepared, entry_rows, prepare

__all__ = ["Store"]

ATTEMPTS = 5
DEADLOCK = "40P01"
# SQLite takes so many parameters in one statement, and more
CHUNK = 400
THERE = select(schema.recordings.c.uuid, schema.recordings.c.digest).where(
    schema.recordings.c.digest.in_(bindparam("digests", expanding=True))
    | schema.recordings.c.uuid.in_(bindparam("ids", expanding=True))
)
TAKEN = "id: {} is that of another recording, expected an id of its own"


class Store:
    """A database with a place for large bytes; `palpate.store.opening.open_store` opens one.

    Threads and processes may share one store. Close it when done, or use it in a ``with`` statement.

    Parameters
    ----------
    engine
        A database whose tables are up to date.
    blobs
        Where large bytes are kept.
    """

    def __init__(self, engine: Engine, blobs: Blobs) -> None:
        self.engine = engine
        self.blobs = blobs
        self._writing = writing(engine)
        self._registry = Registry()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()

    def put(self, recording: Recording) -> Receipt:
        """Keep a recording, in one transaction.

        When this returns the recording is in the store. The same content again is the same recording.

        Raises
        ------
        StoreError
            If it may not be kept (see `palpate.store.checks.check`), or its id belongs to another recording; nothing
            is in the store then. It is an `UnavailableError` where the database cannot be used.
        """
        return self.put_many([recording])[0]

    def put_many(self, recordings: Iterable[Recording]) -> list[Receipt]:
        """Keep several recordings, all in one transaction or none.

        Raises
        ------
        StoreError
            As `put`.
        """
        batch = list(recordings)
        for recording in batch:
            check(recording)
        prepared = [prepare(recording, self.blobs) for recording in batch]
        return self._commit_or_again(prepared, ATTEMPTS)

    def known(self, digests: Iterable[str]) -> set[str]:
        """Which of these digests are those of recordings that are there.

        Raises
        ------
        StoreError
            If one is no digest. It is an `UnavailableError` where the database cannot be asked.
        """
        asked = [_bytes_of(digest) for digest in digests]
        column, found = schema.recordings.c.digest, set[str]()
        try:
            with self.engine.connect() as connection:
                for start in range(0, len(asked), CHUNK):
                    rows = connection.execute(select(column).where(column.in_(asked[start : start + CHUNK])))
                    found.update(digest.hex() for digest in rows.scalars())
        except DatabaseError as error:
            raise UnavailableError(f"store {self.engine.url!r}: {error.orig}") from None
        return found

    def get(self, key: UUID | str) -> Recording:
        """A recording by its id or its digest, verified.

        Raises
        ------
        StoreError
            If there is none.
        DamagedError
            If what is stored is not what was put.
        """
        column = schema.recordings.c.uuid if isinstance(key, UUID) else schema.recordings.c.digest
        with self.engine.connect() as connection:
            found = fetch(connection, self.blobs, column == _bytes_of(key))
        if not found:
            raise StoreError(f"recording {key}: is not in the store")
        return recording_from(found[0])

    def _commit_or_again(self, batch: Sequence[Prepared], attempts: int) -> list[Receipt]:
        try:
            return self._commit(batch)
        except DatabaseError as error:
            # somebody else has just put the same, and the next look finds it; or the two wait for each other
            race = isinstance(error, IntegrityError) or getattr(error.orig, "sqlstate", None) == DEADLOCK
            if race and attempts > 1:
                return self._commit_or_again(batch, attempts - 1)
            raise UnavailableError(f"store {self.engine.url!r}: {error.orig}; nothing was kept") from None

    def _commit(self, batch: Sequence[Prepared]) -> list[Receipt]:
        """One transaction that puts what is not there yet."""
        with self._writing.begin() as connection:
            there = self._present(connection, batch)
            new = {one.recording.digest: one for one in reversed(batch) if one.recording.digest not in there}
            lookup = Lookup(connection, self._registry)
            if new:
                self._insert(lookup, list(reversed(new.values())))
        lookup.keep()
        return [_receipt(one, there, new) for one in batch]

    def _present(self, connection: Connection, batch: Sequence[Prepared]) -> dict[str, UUID]:
        """Which of these recordings are there, by digest; refuse ids that others have."""
        found: dict[str, UUID] = {}
        _check_ids(batch)
        for start in range(0, len(batch), CHUNK):
            part = [one.recording for one in batch[start : start + CHUNK]]
            digests = {bytes.fromhex(recording.digest): recording for recording in part}
            ids = {recording.id.bytes: recording for recording in part}
            rows = connection.execute(THERE, {"digests": list(digests), "ids": list(ids)})
            for uuid, digest in rows:
                if digest in digests:
                    found[digest.hex()] = UUID(bytes=uuid)
                elif uuid in ids:
                    raise StoreError(TAKEN.format(UUID(bytes=uuid)))
        return found

    def _insert(self, lookup: Lookup, batch: Sequence[Prepared]) -> None:
        connection, uploaded_us = lookup.connection, now_us()
        for one in batch:
            lookup.admit_units(one.recording)
        ids = _new_ids(connection, len(batch))
        rows = [one.recording_row(row, lookup, uploaded_us) for row, one in zip(ids, batch, strict=True)]
        insert_rows(connection, schema.recordings, rows)
        numbered = list(zip(rows, batch, strict=True))
        for table, more in (
            (schema.series, [part for row, one in numbered for part in one.series_rows(row["id"], lookup)]),
            (schema.files, [part for row, one in numbered for part in one.file_rows(row["id"])]),
            (schema.entries, [part for row, one in numbered for part in entry_rows(one.recording, row)]),
        ):
            insert_rows(connection, table, more)


def _check_ids(batch: Iterable[Prepared]) -> None:
    """Refuse one id for two recordings of a batch."""
    digests: dict[UUID, str] = {}
    for one in batch:
        if digests.setdefault(one.recording.id, one.recording.digest) != one.recording.digest:
            raise StoreError(TAKEN.format(one.recording.id))


def _receipt(one: Prepared, there: Mapping[str, UUID], new: Mapping[str, Prepared]) -> Receipt:
    digest = one.recording.digest
    if digest in there:
        return Receipt(there[digest], digest, new=False)
    # of two that are the same, the first was kept
    return Receipt(new[digest].recording.id, digest, new=new[digest] is one)


def _new_ids(connection: Connection, count: int) -> list[int]:
    """Row numbers for recordings, known before they are inserted, so that all their rows go in at once."""
    if connection.dialect.name == "postgresql":
        # a sequence is safe while others insert
        asked = "SELECT nextval('recordings_id_seq') FROM generate_series(1, :count)"
        return list(connection.execute(text(asked), {"count": count}).scalars())
    # in SQLite there is one writer at a time
    last = connection.exec_driver_sql("SELECT max(id) FROM recordings").scalar() or 0
    return list(range(last + 1, last + 1 + count))


def _bytes_of(key: UUID | str) -> bytes:
    if isinstance(key, UUID):
        return key.bytes
    try:
        return bytes.fromhex(key)
    except ValueError:
        raise StoreError(f"recording {key!r}: is no digest, expected 64 hexadecimal digits") from None
