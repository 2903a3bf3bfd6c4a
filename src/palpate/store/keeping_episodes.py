"""Putting episodes into a store, and getting them back."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, Connection, insert, or_, select, update
from sqlalchemy.exc import DatabaseError, IntegrityError

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.database import as_of_one_moment, writing
from palpate.store.embargo import embargo_of, embargo_us
from palpate.store.episodes import StoredEpisode, check_episode, episode_from
from palpate.store.errors import StoreError
from palpate.store.filters import digest_bytes
from palpate.store.legible import reading
from palpate.store.outages import not_kept, patiently
from palpate.store.records import Receipt
from palpate.store.registry import Lookup, Registry, thing_of
from palpate.store.rows import microseconds
from palpate.store.store import Store

__all__ = ["get_episode", "put_episode"]

ATTEMPTS = 3
AT_ONCE = 50
Row = Mapping[Any, Any]


def put_episode(store: Store, episode: StoredEpisode, *, uploader: str | None = None) -> Receipt:
    """Keep an episode, in one transaction.

    The same content again is the same episode. One that is in the store may grow: put again under its id with further
    steps, it takes them. Who may see it stays what it is in the store by then, and so does who has sent it first.

    Parameters
    ----------
    store
        Where it is kept.
    episode
        What to keep.
    uploader
        The account that has sent it, where one did.

    Raises
    ------
    StoreError
        If it may not be kept (see `palpate.store.episodes.check_episode`), a recording of its steps is not in the
        store, or its id belongs to another episode; nothing of it is in the store then. It is an `UnavailableError`
        where the database cannot be used.
    """
    check_episode(episode)
    for attempt in range(1, ATTEMPTS + 1):
        try:
            return patiently(lambda: _transaction(store, episode, uploader))
        except DatabaseError as error:
            # somebody else has just put the same, and the next look finds it
            if not isinstance(error, IntegrityError) or attempt == ATTEMPTS:
                raise not_kept(store.engine, error.orig or error) from None
    raise AssertionError("the last attempt returns or raises")


def get_episode(store: Store, key: UUID | str) -> StoredEpisode:
    """An episode by its id or its digest, verified.

    Raises
    ------
    StoreError
        If there is none.
    DamagedError
        If what is stored is not what was put.
    """
    columns = schema.episodes.c
    wanted = columns.uuid == key.bytes if isinstance(key, UUID) else columns.digest == digest_bytes(key)
    # it may grow meanwhile, and its digest is that of all its steps
    with reading(as_of_one_moment(store.engine)) as connection:
        row = connection.execute(_heads().where(wanted)).mappings().first()
        if row is None:
            raise StoreError(f"episode {key}: is not in the store")
        return stored_episode(row, documents_of(connection, row["id"]))


def episodes_of(connection: Connection, ids: Sequence[int]) -> Iterator[StoredEpisode]:
    """The episodes of rows, in order, verified."""
    for some in chunks(ids, AT_ONCE):
        for row in episode_rows(connection, schema.episodes.c.id.in_(some)):
            yield stored_episode(row, documents_of(connection, row["id"]))


def next_ids(connection: Connection, last: int) -> list[int]:
    """Some row numbers of episodes after a given one."""
    column = schema.episodes.c.id
    return list(connection.scalars(select(column).where(column > last).order_by(column).limit(AT_ONCE)))


def _heads() -> Any:
    """Episodes with their objects."""
    episodes, things = schema.episodes, schema.things
    return select(episodes, *(column.label(f"thing_{column.name}") for column in things.c if column.name != "id")).join(
        things, things.c.id == episodes.c.thing_id
    )


def episode_rows(connection: Connection, condition: ColumnElement[bool]) -> Sequence[Row]:
    """Rows of episodes, with those of their objects, as `stored_episode` takes them."""
    found: Sequence[Row] = connection.execute(_heads().where(condition).order_by(schema.episodes.c.id)).mappings().all()
    return found


def stored_episode(row: Row, steps: Sequence[str]) -> StoredEpisode:
    """The episode of a row and the documents of its steps; DamagedError where it is not what was put."""
    thing = thing_of({column.name: row.get(f"thing_{column.name}") for column in schema.things.c})
    return episode_from(
        row["document"],
        steps,
        row["digest"].hex(),
        thing=thing,
        visibility=row["visibility"],
        embargoed_until=embargo_of(row["embargoed_us"]),
        id=UUID(bytes=row["uuid"]),
    )


def documents_of(connection: Connection, episode: int) -> list[str]:
    """The documents of the steps of an episode, in order."""
    steps = schema.episode_steps.c
    asked = select(steps.document).where(steps.episode_id == episode).order_by(steps.position)
    return list(connection.scalars(asked))


def _transaction(store: Store, episode: StoredEpisode, uploader: str | None) -> Receipt:
    with writing(store.engine).begin() as connection:
        return _put(connection, episode, uploader)


def _put(connection: Connection, episode: StoredEpisode, uploader: str | None) -> Receipt:
    columns = schema.episodes.c
    same = or_(columns.digest == bytes.fromhex(episode.digest), columns.uuid == episode.id.bytes)
    asked = select(columns.id, columns.uuid, columns.digest, columns.document).where(same).with_for_update()
    there = connection.execute(asked).mappings().all()
    for row in there:
        if row["digest"].hex() == episode.digest:
            return Receipt(UUID(bytes=row["uuid"]), episode.digest, new=False)
    if there:
        return _grow(connection, there[0], episode)
    thing = Lookup(connection, Registry()).thing(episode.thing)
    shared = {"visibility": episode.visibility, "embargoed_us": embargo_us(episode.embargoed_until)}
    values = {"uuid": episode.id.bytes, "thing_id": thing, "uploaded_by": uploader, **shared, **head_columns(episode)}
    made = insert(schema.episodes).values(**values)
    _add_steps(connection, connection.execute(made.returning(columns.id)).scalar_one(), episode, 0)
    return Receipt(episode.id, episode.digest, new=True)


def _grow(connection: Connection, row: Row, episode: StoredEpisode) -> Receipt:
    """Add the steps that are new to an episode that is there."""
    known, wanted = documents_of(connection, row["id"]), [step.document for step in episode.steps]
    both = min(len(known), len(wanted))
    if row["document"] != episode.document or known[:both] != wanted[:both]:
        raise StoreError(f"id: {episode.id} is that of another episode, expected an id of its own")
    if len(wanted) < len(known):
        # an older copy of what has grown since
        return Receipt(episode.id, row["digest"].hex(), new=False)
    _add_steps(connection, row["id"], episode, len(known))
    changed = update(schema.episodes).where(schema.episodes.c.id == row["id"])
    connection.execute(changed.values(**head_columns(episode)))
    return Receipt(episode.id, episode.digest, new=True)


def head_columns(episode: StoredEpisode) -> dict[str, Any]:
    """What the columns of an episode hold and repeat of its content."""
    return {
        "digest": bytes.fromhex(episode.digest),
        "started_us": microseconds(episode.started_at),
        "owner": episode.owner,
        "actions": episode.actions,
        "stop": episode.stop,
        "document": episode.document,
    }


def _add_steps(connection: Connection, row: int, episode: StoredEpisode, first: int) -> None:
    links = recordings_of(connection, episode)
    steps = list(enumerate(episode.steps))[first:]
    for place, step in steps:
        if step.recording is not None and step.recording not in links:
            raise StoreError(
                f"steps[{place}].recording: {step.recording} is not in the store, expected the digest of a recording"
            )
    rows = [
        {
            "episode_id": row,
            "position": place,
            "recording_id": links.get(step.recording or ""),
            "document": step.document,
        }
        for place, step in steps
    ]
    if rows:
        connection.execute(insert(schema.episode_steps), rows)


def recordings_of(connection: Connection, episode: StoredEpisode) -> Mapping[str, int]:
    """Rows of the recordings of an episode that are in the store, by digest."""
    columns = schema.recordings.c
    digests = [bytes.fromhex(step.recording) for step in episode.steps if step.recording is not None]
    found: dict[str, int] = {}
    for some in chunks(digests):
        asked = select(columns.digest, columns.id).where(columns.digest.in_(some))
        found |= {row.digest.hex(): row.id for row in connection.execute(asked)}
    return found
