"""What is wanted for all of an upload: who may see it, from when on, and whose it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime

from palpate.errors import choices
from palpate.server.receiving import check_owner
from palpate.server.security.accounts import Account
from palpate.server.sharing import embargo_end
from palpate.store.errors import StoreError
from palpate.store.importing.items import identified
from palpate.store.records import VISIBILITIES, Recording

__all__ = ["Wishes"]


@dataclass(frozen=True)
class Wishes:
    """What is wanted for all recordings of an upload.

    Attributes
    ----------
    visibility
        As each states where it is None.
    owner
        Of those that state none; it stays so where this is None.
    embargoed_until
        Until when others do not see them; as each states where it is None.
    ends_embargoes
        Whether there is no embargo, also where one is stated.
    """

    visibility: str | None = None
    owner: str | None = None
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
        >>> Wishes.of_form({"visibility": "lab", "owner": " ann "})
        Wishes(visibility='lab', owner='ann', embargoed_until=None, ends_embargoes=False)
        """
        visibility, until = fields.get("visibility") or None, fields.get("until", "").strip()
        if visibility is not None and visibility not in VISIBILITIES:
            raise StoreError(f"visibility: found {visibility[:40]!r}; {choices(VISIBILITIES)}")
        ends = fields.get("no_embargo") == "yes"
        if ends and until:
            raise StoreError(f"until: found {until[:40]!r} beside the wish for no embargo, expected one of the two")
        return cls(visibility, fields.get("owner", "").strip() or None, embargo_end(until) if until else None, ends)

    def of(self, recording: Recording, who: Account) -> Recording:
        """The recording as it is wanted; StoreError where the account may not keep it so."""
        if self.owner is not None and recording.owner is None:
            recording = identified(replace(recording, owner=self.owner))
        if self.visibility is not None:
            recording = replace(recording, visibility=self.visibility)
        if self.embargoed_until is not None or self.ends_embargoes:
            recording = replace(recording, embargoed_until=self.embargoed_until)
        check_owner(recording, who)
        return recording
