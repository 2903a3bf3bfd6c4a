"""The forms of who may see a recording or an exploration."""

from __future__ import annotations

from datetime import datetime
from typing import Literal
from uuid import UUID

from palpate.server.api.models.basics import Strict, Undoable
from palpate.server.api.models.objects import ThingName

__all__ = ["Kept", "Sharing", "SharingChange", "Visibility"]

Visibility = Literal["private", "lab", "public"]


class Sharing(Strict):
    """Who may see something, and until when nobody else does."""

    visibility: Visibility
    embargoed_until: datetime | None


class SharingChange(Undoable):
    """A change of who may see something: what held before and after, and whether it was taken back."""

    before: Sharing
    after: Sharing


class Kept(Sharing):
    """What a recording and an exploration tell alike: what it is of, whose it is, and where it is."""

    id: UUID
    digest: str
    object: ThingName
    common_name: str | None
    owner: str | None
    url: str
