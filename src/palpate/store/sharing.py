"""Who may see a recording or an exploration, set again later: noted with who did it, and reversible.

Visibility and embargo stand beside the content: no digest covers them, and no measurement changes.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from sqlalchemy import ColumnElement, Connection, Table, select, true, update

from palpate.errors import choices
from palpate.store import schema
from palpate.store.audit import note, take_back
from palpate.store.checks import check_embargo
from palpate.store.content import in_utc
from palpate.store.database import changing
from palpate.store.decoding import moment_from
from palpate.store.embargo import embargo_of, embargo_us
from palpate.store.errors import StoreError
from palpate.store.legible import legible, reading
from palpate.store.records import VISIBILITIES, visibility_now
from palpate.store.rows import EPOCH, moment_at
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["SHARED", "Shared", "Sharing", "SharingChange", "share", "shared", "sharing_history", "undo_sharing"]

SHARED = "shared otherwise"
LINKS = {"recordings": "recording_id", "episodes": "episode_id"}
NAMES = {"recordings": "recording", "episodes": "episode"}
Row = Mapping[Any, Any]


@dataclass(frozen=True)
class Sharing:
    """Who may see something: private, lab or public, and until when nobody else does."""

    visibility: str
    embargoed_until: datetime | None = None

    @property
    def now(self) -> str:
        """Who may see it now."""
        return visibility_now(self.visibility, self.embargoed_until)


@dataclass(frozen=True)
class Shared:
    """Whose a recording or an exploration is, and who may see it."""

    owner: str | None
    uploaded_by: str | None
    sharing: Sharing

    def is_of(self, name: str | None) -> bool:
        """Whether it is somebody's: its owner's, and where none is stated that of who has sent it."""
        return name is not None and name == (self.uploaded_by if self.owner is None else self.owner)


@dataclass(frozen=True)
class SharingChange:
    """A line of the audit about who may see something; `undone_at` is None where it holds."""

    at: datetime
    who: str | None
    before: Sharing
    after: Sharing
    undone_at: datetime | None
    undone_by: str | None


def shared(store: Store, table: Table, key: UUID, viewer: Viewer | None = None) -> Shared | None:
    """Whose something is and who may see it, or None where there is none to see.

    Parameters
    ----------
    table
        `schema.recordings` or `schema.episodes`.
    key
        Its id.
    viewer
        Who looks; all is there unless given.
    """
    seen = true() if viewer is None else viewer.of(table)
    with reading(store.engine) as connection:
        row = _row(connection, table, key, seen)
    return None if row is None else Shared(row["owner"], row["uploaded_by"], _sharing(row))


def share(
    store: Store, table: Table, key: UUID, edit: Callable[[Sharing], Sharing], *, who: str | None = None
) -> Sharing:
    """Set who may see something; `undo_sharing` takes it back.

    Parameters
    ----------
    table, key
        As of `shared`.
    edit
        Gives what shall hold, from what holds.
    who
        Who decided it, for the audit.

    Returns
    -------
    Sharing
        As it is now.

    Raises
    ------
    StoreError
        If it is not in the store, or nothing may be shared so.

    Examples
    --------
    ::

        share(store, schema.recordings, recording.id, lambda _: Sharing("public"), who="ann")
    """
    with changing(store.engine) as connection:
        row = _locked(connection, table, key)
        before = _sharing(row)
        after = edit(before)
        _check(after)
        if after != before:
            _write(connection, table, row["id"], after)
            detail = {"before": _plain(before), "after": _plain(after)}
            note(connection, None, SHARED, detail, who, **{LINKS[table.name]: row["id"]})
        return after


def undo_sharing(store: Store, table: Table, key: UUID, *, who: str | None = None) -> Sharing:
    """Take back the last change of who may see something; called again, the one before.

    Raises
    ------
    StoreError
        If it is not in the store, or there is nothing to take back.
    """
    with changing(store.engine) as connection:
        row = _locked(connection, table, key)
        audit = schema.audit.c
        holds = (*_about(table, row["id"]), audit.undone_us.is_(None))
        asked = select(schema.audit).where(*holds).order_by(audit.id.desc()).limit(1)
        last = connection.execute(asked).mappings().first()
        if last is None:
            raise StoreError(f"{NAMES[table.name]} {key}: has no change of who may see it, expected one to take back")
        with legible(f"the audit of {NAMES[table.name]} {key}"):
            before = _from(json.loads(last["detail"])["before"])
        _write(connection, table, row["id"], before)
        take_back(connection, last, who)
        return before


def sharing_history(store: Store, table: Table, key: UUID) -> tuple[SharingChange, ...]:
    """Who changed who may see something, the last first."""
    with reading(store.engine) as connection:
        row = _row(connection, table, key, true())
        if row is None:
            return ()
        asked = select(schema.audit).where(*_about(table, row["id"])).order_by(schema.audit.c.id.desc())
        return tuple(_change(one, f"{NAMES[table.name]} {key}") for one in connection.execute(asked).mappings())


def _about(table: Table, row: int) -> tuple[ColumnElement[bool], ...]:
    audit = schema.audit.c
    return (audit[LINKS[table.name]] == row, audit.what == SHARED)


def _row(connection: Connection, table: Table, key: UUID, condition: ColumnElement[bool]) -> Row | None:
    names = ("id", "owner", "uploaded_by", "visibility", "embargoed_us")
    asked = select(*(table.c[name] for name in names)).where(table.c.uuid == key.bytes, condition)
    return connection.execute(asked).mappings().first()


def _locked(connection: Connection, table: Table, key: UUID) -> Row:
    """What nobody else changes until the transaction ends."""
    columns = (table.c.id, table.c.visibility, table.c.embargoed_us)
    asked = select(*columns).where(table.c.uuid == key.bytes).with_for_update(key_share=True)
    row = connection.execute(asked).mappings().first()
    if row is None:
        raise StoreError(f"{NAMES[table.name]} {key}: is not in the store")
    return row


def _write(connection: Connection, table: Table, row: int, sharing: Sharing) -> None:
    values = {"visibility": sharing.visibility, "embargoed_us": embargo_us(sharing.embargoed_until)}
    connection.execute(update(table).where(table.c.id == row).values(**values))


def _check(sharing: Sharing) -> None:
    if sharing.visibility not in VISIBILITIES:
        raise StoreError(f"visibility: found {sharing.visibility!r}; {choices(VISIBILITIES)}")
    check_embargo(sharing.embargoed_until)


def _sharing(row: Row) -> Sharing:
    return Sharing(row["visibility"], embargo_of(row["embargoed_us"]))


def _plain(sharing: Sharing) -> dict[str, str | None]:
    until = sharing.embargoed_until
    return {"visibility": sharing.visibility, "embargoed_until": None if until is None else in_utc(until)}


def _from(plain: Mapping[str, Any]) -> Sharing:
    until = plain["embargoed_until"]
    return Sharing(plain["visibility"], None if until is None else moment_from(until))


def _change(row: Row, where: str) -> SharingChange:
    with legible(f"the audit of {where}"):
        detail = json.loads(row["detail"])
        before, after = (_from(detail[name]) for name in ("before", "after"))
    at, undone = (None if us is None else moment_at(us) for us in (row["at_us"], row["undone_us"]))
    return SharingChange(at or EPOCH, row["who"], before, after, undone, row["undone_by"])
