"""Until when others do not see what is for the lab or public: an embargo, around the content like the visibility."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from datetime import datetime
from typing import TYPE_CHECKING, TypeVar

from sqlalchemy import ColumnElement, Table, and_, or_

from palpate.store.content import in_utc
from palpate.store.decoding import moment_from
from palpate.store.rows import microseconds, moment_at

if TYPE_CHECKING:
    from palpate.store.episodes import StoredEpisode
    from palpate.store.records import Recording

__all__ = ["Embargoes", "embargo_of", "embargo_stated", "embargo_us", "is_over", "is_seen_as", "with_embargo"]

Shared = TypeVar("Shared", "Recording", "StoredEpisode")
Embargoes = Mapping[str, tuple[str, str]]
"""Visibility and end of the embargo of recordings and episodes, by digest."""


def embargo_stated(one: Recording | StoredEpisode) -> Embargoes:
    """What an archive states of the embargo of something, by its digest; nothing where there is none."""
    if one.embargoed_until is None:
        return {}
    return {one.digest: (one.visibility, in_utc(one.embargoed_until))}


def with_embargo(one: Shared, stated: Embargoes) -> Shared:
    """The same as it was when an archive stated its embargo."""
    if one.digest not in stated:
        return one
    visibility, until = stated[one.digest]
    return replace(one, visibility=visibility, embargoed_until=moment_from(until))


def embargo_us(moment: datetime | None) -> int | None:
    """The end of an embargo as it stands in the tables."""
    return None if moment is None else microseconds(moment)


def embargo_of(us: int | None) -> datetime | None:
    """The end of an embargo from the tables.

    Examples
    --------
    >>> print(embargo_of(1_700_000_000_000_000))
    2023-11-14 22:13:20+00:00
    """
    return None if us is None else moment_at(us)


def is_over(table: Table, now_us: int) -> ColumnElement[bool]:
    """The condition on `schema.recordings` or `schema.episodes` that there is no embargo any more."""
    return or_(table.c.embargoed_us.is_(None), table.c.embargoed_us <= now_us)


def is_seen_as(table: Table, visibility: str, now_us: int) -> ColumnElement[bool]:
    """The condition that a row is of a visibility now: what is embargoed is private until then."""
    if visibility == "private":
        return or_(table.c.visibility == visibility, table.c.embargoed_us > now_us)
    return and_(table.c.visibility == visibility, is_over(table, now_us))
