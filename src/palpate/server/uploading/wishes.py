"""What is wanted for all of an upload: who may see it, and from when on.

Nothing else is: what is sent is kept as it was sent, so that it is the same whoever sends it, and by whatever way.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TypeVar

from palpate.errors import choices
from palpate.server.sharing import embargo_end
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import StoreError
from palpate.store.records import VISIBILITIES, Recording

__all__ = ["Wishes"]


Shared = TypeVar("Shared", Recording, StoredEpisode)


@dataclass(frozen=True)
class Wishes:
    """What is wanted for all recordings and explorations of an upload.

    Attributes
    ----------
    visibility
        As each states where it is None.
    embargoed_until
        Until when others do not see them; as each states where it is None.
    ends_embargoes
        Whether there is no embargo, also where one is stated.
    """

    visibility: str | None = None
    embargoed_until: datetime | None = None
    ends_embargoes: bool = False

    @classmethod
    def of_form(cls, fields: Mapping[str, str]) -> Wishes:
        """Those of a form.

        Raises
        ------
        StoreError
            Naming the field that is wrong.

        Examples
        --------
        >>> Wishes.of_form({"visibility": "lab"})
        Wishes(visibility='lab', embargoed_until=None, ends_embargoes=False)
        """
        visibility, until = fields.get("visibility") or None, fields.get("until", "").strip()
        if visibility is not None and visibility not in VISIBILITIES:
            raise StoreError(f"visibility: found {visibility[:40]!r}; {choices(VISIBILITIES)}")
        ends = fields.get("no_embargo") == "yes"
        if ends and until:
            raise StoreError(f"until: found {until[:40]!r} beside the wish for no embargo, expected one of the two")
        return cls(visibility, embargo_end(until) if until else None, ends)

    def of(self, one: Shared) -> Shared:
        """A recording or an exploration as it is wanted: by its digest the same one."""
        if self.visibility is not None:
            one = replace(one, visibility=self.visibility)
        if self.embargoed_until is not None or self.ends_embargoes:
            one = replace(one, embargoed_until=self.embargoed_until)
        return one
