"""What is wanted for all of an upload: who may see it, from when on, and whose it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from typing import TypeVar
from uuid import NAMESPACE_URL, uuid5

from palpate.errors import choices
from palpate.server.receiving import check_owner
from palpate.server.security.accounts import Account
from palpate.server.sharing import embargo_end
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import StoreError
from palpate.store.importing.items import identified
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
        recording = self._shared(recording)
        check_owner(recording, who)
        return recording

    def of_episode(self, episode: StoredEpisode, digests: Mapping[str, str]) -> StoredEpisode:
        """The exploration as it is wanted; its steps name the recordings by the digests that these have now."""
        steps = tuple(
            step if step.recording is None else replace(step, recording=digests.get(step.recording, step.recording))
            for step in episode.steps
        )
        owner = self.owner if episode.owner is None else episode.owner
        if (owner, steps) != (episode.owner, episode.steps):
            # it is another one by that, and the same upload gives the same again
            episode = replace(episode, owner=owner, steps=steps)
            episode = replace(episode, id=uuid5(NAMESPACE_URL, f"palpate:{episode.digest}"))
        return self._shared(episode)

    def _shared(self, one: Shared) -> Shared:
        if self.visibility is not None:
            one = replace(one, visibility=self.visibility)
        if self.embargoed_until is not None or self.ends_embargoes:
            one = replace(one, embargoed_until=self.embargoed_until)
        return one
