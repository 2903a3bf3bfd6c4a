"""What waits for who has sent it, so that who closed the page finds it again."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime

from palpate.server.uploading.previews import Previews

__all__ = ["Mine", "mine_of"]

MOST_NAMED = 3


@dataclass(frozen=True)
class Mine:
    """An upload that waits.

    Attributes
    ----------
    id
        Of its page.
    name
        The first of its files.
    until
        When it is forgotten.
    """

    id: str
    name: str
    until: datetime


def mine_of(previews: Previews, holder: str) -> Iterator[Mine]:
    """All that wait for a holder, the oldest first."""
    for one in previews.of(holder):
        try:
            names = sorted({str(item["source"]).partition("/")[0] for item in one.found()})
        except FileNotFoundError:
            # it was kept or cancelled just now
            continue
        more = f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else ""
        yield Mine(one.id, ", ".join(names[:MOST_NAMED]) + more, datetime.fromtimestamp(one.ends_at, UTC))
