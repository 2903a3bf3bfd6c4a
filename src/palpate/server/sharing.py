"""Who may see a recording or an exploration, set over the network: by whom, and under whose name it is noted.

Its owner may, and where none is stated who has sent it; a curator may where they see it.
"""

from __future__ import annotations

from dataclasses import dataclass
from datetime import UTC, datetime
from typing import Any
from uuid import UUID

from sqlalchemy import Table

from palpate.server.problems import problem
from palpate.server.security.accounts import Account, Role
from palpate.store.checks import check_embargo
from palpate.store.errors import StoreError
from palpate.store.sharing import (
    Shared,
    Sharing,
    SharingChange,
    share,
    shared,
    sharing_history,
    undo_sharing,
)
from palpate.store.store import Store

__all__ = ["SharingOf", "embargo_end", "sharing_of"]


@dataclass(frozen=True)
class SharingOf:
    """Who may see one thing, as somebody who sees it may set it; what they may not is a 403."""

    store: Store
    who: Account
    table: Table
    key: UUID
    now: Shared

    @property
    def may_change(self) -> bool:
        """Whether they may set it."""
        if self.who.role >= Role.CURATOR:
            return True
        return self.who.role >= Role.OWNER and self.now.is_of(self.who.name)

    def change(self, fields: dict[str, Any]) -> Sharing:
        """Set the visibility, the end of the embargo, or both."""
        self.check()

        def edited(before: Sharing) -> Sharing:
            until: datetime | None = fields.get("embargoed_until", before.embargoed_until)
            return Sharing(fields.get("visibility") or before.visibility, until)

        return share(self.store, self.table, self.key, edited, who=self.who.name)

    def undo(self) -> Sharing:
        """Take back the last change that holds."""
        self.check()
        return undo_sharing(self.store, self.table, self.key, who=self.who.name)

    def history(self) -> tuple[SharingChange, ...]:
        """Who changed what, the last first."""
        self.check()
        return sharing_history(self.store, self.table, self.key)

    def check(self) -> None:
        """Refuse, with a 403, who may not set it."""
        if not self.may_change:
            raise problem(403, f"{self.table.name[:-1]} {self.key}: is for its owner to share, or for curators")


def embargo_end(text: str) -> datetime:
    """The end of an embargo from the field ``until`` of a form, in UTC unless it says otherwise.

    Raises
    ------
    StoreError
        If it is none.

    Examples
    --------
    >>> print(embargo_end("2030-12-31"))
    2030-12-31 00:00:00+00:00
    """
    try:
        found = datetime.fromisoformat(text)
    except ValueError:
        raise StoreError(f"until: found {text[:40]!r}, expected a date and a time, as 2030-12-31T12:00") from None
    found = found if found.utcoffset() is not None else found.replace(tzinfo=UTC)
    check_embargo(found)
    return found


def sharing_of(store: Store, who: Account, table: Table, key: UUID) -> SharingOf:
    """Who may see something that is seen, or a 404."""
    now = shared(store, table, key, who.viewer)
    if now is None:
        raise problem(404, f"{table.name[:-1]} {key}: there is none, or none that you may see")
    return SharingOf(store, who, table, key, now)
