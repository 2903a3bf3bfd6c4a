"""The store: put recordings in, get them back."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from types import TracebackType
from typing import Any, Self
from uuid import UUID

from sqlalchemy import Engine, select
from sqlalchemy.engine.interfaces import DBAPICursor
from sqlalchemy.exc import DatabaseError, DBAPIError

from palpate.store import schema
from palpate.store.blobs import Blobs
from palpate.store.checks import check
from palpate.store.chunks import chunks
from palpate.store.database import asking, writing
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.fetching import fetch, whole
from palpate.store.implausible import implausible
from palpate.store.inserting import Statements
from palpate.store.legible import reading
from palpate.store.outages import not_kept, patiently
from palpate.store.records import Receipt, Recording
from palpate.store.registry import Lookup, NotRememberedError, Registry, now_us, units_in
from palpate.store.rows import Prepared, counted, entry_rows, prepare
from palpate.store.senders import note_sender
from palpate.store.together import Together

__all__ = ["Store"]

ATTEMPTS = 5
DEADLOCK = "40P01"
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
        self._statements = Statements(engine)
        self._registry = Registry()
        self._together = Together[Prepared, Receipt](lambda batch: self._commit_or_again(batch, ATTEMPTS))

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """Close all connections."""
        self.engine.dispose()

    def put(self, recording: Recording, *, uploader: str | None = None) -> Receipt:
        """Keep a recording, in one transaction.

        When this returns the recording is in the store. The same content again is the same recording.

        Parameters
        ----------
        recording
            What to keep.
        uploader
            The account that has sent it, where one did. Of several that send the same, the first decides who else
            sees it, and all see it; to one from whom it was hidden it is new.

        Raises
        ------
        StoreError
            If it may not be kept (see `palpate.store.checks.check`), or its id belongs to another recording; nothing
            is in the store then. It is an `UnavailableError` where the database cannot be used.
        """
        return self.put_many([recording], uploader=uploader)[0]

    def put_many(
        self,
        recordings: Iterable[Recording],
        *,
        known_wrong: Collection[str] = (),
        uploader: str | None = None,
    ) -> list[Receipt]:
        """Keep several recordings, all in one transaction or none.

        Parameters
        ----------
        recordings
            What to keep.
        known_wrong
            Digests of those whose results may be in a unit of another dimension than their property's: they are kept
            and do not count (see `palpate.store.units.change_unit`).
        uploader
            As of `put`.

        Raises
        ------
        StoreError
            As `put`.
        """
        batch = list(recordings)
        for recording in batch:
            check(recording)
        return self.put_checked(batch, known_wrong=known_wrong, uploader=uploader)

    def put_checked(
        self, recordings: Iterable[Recording], *, known_wrong: Collection[str] = (), uploader: str | None = None
    ) -> list[Receipt]:
        """Keep recordings that `palpate.store.checks.check` has let through, otherwise as `put_many`."""
        prepared = [prepare(recording, self.blobs, uploader=uploader) for recording in recordings]
        if known_wrong:
            prepared = [replace(one, is_known_wrong=one.recording.digest in known_wrong) for one in prepared]
        receipts = self._together.commit(prepared) if prepared else []
        if uploader is not None:
            again = [one.digest for one in receipts if not one.new]
            hidden = self.note_sender(again, uploader)
            receipts = [replace(one, new=one.new or one.digest in hidden) for one in receipts]
        return receipts

    def note_sender(self, digests: Sequence[str], name: str) -> set[str]:
        """Note that an account has sent recordings that are there; digests of those that were hidden from it."""
        return note_sender(self.engine, digests, name) if digests else set()

    def known(self, digests: Iterable[str]) -> set[str]:
        """Which of these digests are those of recordings that are there.

        Raises
        ------
        StoreError
            If one is no digest. It is an `UnavailableError` where the database cannot be asked.
        """
        asked = [_bytes_of(digest) for digest in digests]
        try:
            return patiently(lambda: self._known(asked))
        except DatabaseError as error:
            raise UnavailableError(f"store {self.engine.url!r}: {error.orig}") from None

    def _known(self, asked: Sequence[bytes]) -> set[str]:
        column, found = schema.recordings.c.digest, set[str]()
        with asking(self.engine) as connection:
            for some in chunks(asked):
                rows = connection.execute(select(column).where(column.in_(some)))
                found.update(digest.hex() for digest in rows.scalars())
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
        with reading(self.engine) as connection:
            found = fetch(connection, self.blobs, column == _bytes_of(key))
        if not found:
            raise StoreError(f"recording {key}: is not in the store")
        return whole(found[0])

    def _commit_or_again(self, batch: Sequence[Prepared], attempts: int) -> list[Receipt]:
        driver = self.engine.dialect.loaded_dbapi
        try:
            return patiently(lambda: self._commit(batch))
        except (DBAPIError, driver.Error) as found:
            error = found.orig if isinstance(found, DBAPIError) else found
            # somebody else has just put the same, and the next look finds it; or the two wait for each other
            race = isinstance(error, driver.IntegrityError) or getattr(error, "sqlstate", None) == DEADLOCK
            if race and attempts > 1:
                return self._commit_or_again(batch, attempts - 1)
            raise not_kept(self.engine, error or found) from None

    def _commit(self, batch: Sequence[Prepared]) -> list[Receipt]:
        """One transaction that puts what is not there yet."""
        try:
            with self._statements.transaction() as cursor:
                return self._put(cursor, self._registry, batch)
        except NotRememberedError:
            with self._writing.begin() as connection:
                lookup = Lookup(connection, self._registry)
                receipts = self._put(connection.connection.cursor(), lookup, batch)
            lookup.keep()
            return receipts

    def _put(self, cursor: DBAPICursor, shared: Registry, batch: Sequence[Prepared]) -> list[Receipt]:
        there = self._present(cursor, batch)
        new = {one.recording.digest: one for one in reversed(batch) if one.recording.digest not in there}
        if new:
            _check_ids(new.values(), there.values())
            self._insert(cursor, shared, list(reversed(new.values())))
        return [_receipt(one, there, new) for one in batch]

    def _present(self, cursor: DBAPICursor, batch: Sequence[Prepared]) -> dict[str, UUID]:
        """Digest and id of what is there that has a digest, or an id, of these."""
        digests = [bytes.fromhex(one.recording.digest) for one in batch]
        ids = [one.recording.id.bytes for one in batch]
        return {digest.hex(): UUID(bytes=uuid) for uuid, digest in self._statements.present(cursor, digests, ids)}

    def _insert(self, cursor: DBAPICursor, shared: Registry, batch: Sequence[Prepared]) -> None:
        uploaded_us = now_us()
        names = {name for one in batch for _, (name, _) in units_in(one.recording)}
        units = self._statements.units(cursor, list(names))
        for one in batch:
            shared.admit_units(one.recording, units, is_known_wrong=one.is_known_wrong)
        # in one order, so that no two puts wait for each other's objects
        things = [one.recording.thing for one in batch] if len(batch) > 1 else []
        for thing in sorted(things, key=lambda thing: (thing.dataset, thing.id)):
            shared.thing(thing)
        ids = self._statements.new_ids(cursor, len(batch))
        rows = [one.recording_row(row, shared, uploaded_us) for row, one in zip(ids, batch, strict=True)]
        numbered = list(zip(rows, batch, strict=True))
        for table, more in (
            (schema.recordings, rows),
            (schema.series, [part for row, one in numbered for part in one.series_rows(row["id"], shared)]),
            (schema.files, [part for row, one in numbered for part in one.file_rows(row["id"])]),
            (schema.entries, [part for row, one in numbered for part in _entries(one, row, units)]),
        ):
            self._statements.insert(cursor, table, more)


def _entries(one: Prepared, row: Mapping[str, Any], units: Mapping[str, str]) -> Iterator[Mapping[str, Any]]:
    rows = entry_rows(one.recording, row)
    return (counted(part, units) for part in rows) if one.is_known_wrong else rows


def _check_ids(new: Iterable[Prepared], there: Iterable[UUID]) -> None:
    """Refuse an id that is there, or that two recordings have."""
    taken = set(there)
    for one in new:
        if one.recording.id in taken:
            raise StoreError(TAKEN.format(one.recording.id))
        taken.add(one.recording.id)


def _receipt(one: Prepared, there: Mapping[str, UUID], new: Mapping[str, Prepared]) -> Receipt:
    digest, notices = one.recording.digest, implausible(one.recording)
    if digest in there:
        return Receipt(there[digest], digest, new=False, notices=notices)
    # of two that are the same, the first was kept
    return Receipt(new[digest].recording.id, digest, new=new[digest] is one, notices=notices)


def _bytes_of(key: UUID | str) -> bytes:
    if isinstance(key, UUID):
        return key.bytes
    try:
        return bytes.fromhex(key)
    except ValueError:
        raise StoreError(f"recording {key!r}: is no digest, expected 64 hexadecimal digits") from None
