"""What will become of what an upload holds when it is kept: a preview counts nothing else."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any
from uuid import UUID

from palpate.server.explorations import fate_of_whole
from palpate.server.security.accounts import Account
from palpate.server.uploading.preview import OF_OTHERS
from palpate.store.importing.items import Fate
from palpate.store.importing.presence import ids_of_others
from palpate.store.keeping_episodes import get_episode
from palpate.store.store import TAKEN, Store
from palpate.store.viewing import Viewer
from palpate.store.visible_episodes import episode_is_there, recordings_of_digests

__all__ = ["ALL", "TWICE", "Coming", "coming", "fate_of_exploration"]

ALL = Viewer(everything=True)
TWICE = "twice"
"""Of what stands in the same upload before."""


@dataclass(frozen=True)
class Coming:
    """What will become of an item.

    Attributes
    ----------
    fate
        A value of `Fate`, or `TWICE`.
    reason
        Why it will not be kept; None where it will.
    known
        The id under which the store has it already, where the account sees it.
    """

    fate: str
    reason: str | None = None
    known: UUID | None = None

    @property
    def is_kept(self) -> bool:
        """Whether it is in the store afterwards, and was not counted before."""
        return self.fate in (Fate.NEW.value, Fate.KNOWN.value)


def coming(store: Store, who: Account, scratch: Store, found: Sequence[Mapping[str, Any]]) -> list[Coming]:
    """What will become of each item of an upload that is no exploration, in their order."""
    digests = [one["digest"] for one in found if one["digest"] is not None]
    known, ids = recordings_of_digests(store, who.viewer, digests), recordings_of_digests(scratch, ALL, digests)
    taken, before = ids_of_others(store, ids), set[str | None]()
    told = list[Coming]()
    for one in found:
        digest = one["digest"]
        if one["fate"] in (Fate.REFUSED.value, Fate.SKIPPED.value):
            told.append(Coming(one["fate"], one["reason"]))
        elif digest is None or digest in before:
            # one that an archive names again is not even read
            told.append(Coming(TWICE))
        elif digest in known:
            told.append(Coming(Fate.KNOWN.value, None, known[digest]))
        elif OF_OTHERS in one:
            told.append(Coming(Fate.REFUSED.value, one[OF_OTHERS]))
        elif digest in taken:
            told.append(Coming(Fate.REFUSED.value, TAKEN.format(ids[digest])))
        else:
            told.append(Coming(Fate.NEW.value))
        before.add(digest)
    return told


def fate_of_exploration(store: Store, who: Account, scratch: Store, key: UUID) -> Fate:
    """What will become of an exploration of an upload."""
    # of most of them the store knows nothing, and they need not be read
    return fate_of_whole(store, who, get_episode(scratch, key)) if episode_is_there(store, key) else Fate.NEW
