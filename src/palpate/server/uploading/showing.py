"""What a preview shows of each item."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import UUID

from palpate.server.pages.allowance import Allowance
from palpate.server.security.accounts import Account
from palpate.server.uploading.drawing import Drawn, drawn
from palpate.server.uploading.fates import ALL, Coming, coming, fate_of_exploration
from palpate.server.uploading.preview import Preview
from palpate.store.importing.items import Fate
from palpate.store.opening import open_store
from palpate.store.parts import Head, head_of
from palpate.store.store import Store
from palpate.store.visible_episodes import episode_is_visible

__all__ = ["Shown", "ShownEpisode", "shown_episodes", "shown_of"]

MOST_SHOWN = 200
MOST_DRAWN = 12
NOTHING = Drawn()


@dataclass(frozen=True)
class Shown:
    """An item of an upload.

    Attributes
    ----------
    source
        The file.
    coming
        What will become of it.
    head
        The recording; None where none is kept, or where too many came before it.
    drawn
        What is seen and heard of it.
    """

    source: str
    coming: Coming
    head: Head | None = None
    drawn: Drawn = NOTHING


@dataclass(frozen=True)
class ShownEpisode:
    """An exploration of an upload.

    Attributes
    ----------
    source
        The file.
    told
        What `palpate.server.uploading.archives` leaves of it.
    fate
        What will become of it.
    is_seen
        Whether the store has it, or a part of it, and the account sees that.
    """

    source: str
    told: Mapping[str, Any]
    fate: Fate
    is_seen: bool

    @property
    def started_at(self) -> datetime:
        """When."""
        return datetime.fromisoformat(self.told["started_at"])

    @property
    def embargoed_until(self) -> datetime | None:
        """Until when it is embargoed, as it states."""
        until = self.told["embargoed_until"]
        return None if until is None else datetime.fromisoformat(until)


def shown_episodes(store: Store, who: Account, preview: Preview) -> list[ShownEpisode]:
    """All explorations of a preview, each once."""
    found = {one["episode"]["id"]: one for one in reversed(preview.found()) if one["episode"] is not None}
    if not found:
        return []
    with open_store(preview.place, preview.blobs, durable=False, make=False) as scratch:
        return [
            ShownEpisode(
                one["source"],
                one["episode"],
                fate_of_exploration(store, who, scratch, UUID(key)),
                episode_is_visible(store, who.viewer, UUID(key)),
            )
            for key, one in reversed(found.items())
        ]


def shown_of(store: Store, who: Account, preview: Preview, left: Allowance) -> list[Shown]:
    """All recordings of a preview, the first ones with what is seen and heard, and what is refused or left out."""
    found = [one for one in preview.found() if one["episode"] is None]
    items, seen, pictured = list[Shown](), 0, 0
    with open_store(preview.place, preview.blobs, durable=False, make=False) as scratch:
        for one, become in zip(found, coming(store, who, scratch, found), strict=True):
            head = None
            if become.is_kept and seen < MOST_SHOWN:
                head = head_of(scratch, ALL, bytes.fromhex(one["digest"]))
            looks = drawn(scratch, head, left) if head is not None and pictured < MOST_DRAWN else NOTHING
            seen += head is not None
            pictured += bool(looks)
            items.append(Shown(one["source"], become, head, looks))
    return items
