"""Keeping what was shown: from the store in which it waits into that of the server."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import partial
from pathlib import Path
from typing import Any
from uuid import UUID

from palpate.server.explorations import keep_whole
from palpate.server.receiving import check_owner
from palpate.server.security.accounts import Account
from palpate.server.state import State
from palpate.server.uploading.preview import OF_OTHERS, Preview
from palpate.server.uploading.wishes import Wishes
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.keeping_episodes import get_episode
from palpate.store.opening import open_store
from palpate.store.records import Recording
from palpate.store.store import Store
from palpate.store.visible_episodes import recordings_of_digests

__all__ = ["keep"]


class _Waiting:
    """The recordings of a preview, as a format of imports."""

    def __init__(self, scratch: Store, preview: Preview, wishes: Wishes, who: Account, seen: Collection[str]) -> None:
        self._scratch = scratch
        self._preview = preview
        self._wishes = wishes
        self._who = who
        self._seen = seen

    def owns(self, path: Path) -> bool:
        """The store in which they are."""
        return path == self._preview.place

    def count(self, path: Path) -> int:
        """Nobody watches how far it is."""
        return 1

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """Each recording once; of others the store has what may be told of, and nobody is noted as its sender."""
        told = {one["digest"]: one for one in self._preview.found() if one["digest"] is not None}
        for digest, one in told.items():
            if one.get(OF_OTHERS) and digest in self._seen:
                yield Outcome(one["source"], Fate.KNOWN, None, self._scratch.get(digest))
            else:
                yield Item(one["source"], partial(self._read, digest))

    def _read(self, digest: str) -> Recording:
        sent = self._scratch.get(digest)
        check_owner(sent, self._who)
        return self._wishes.of(sent)


def keep(state: State, who: Account, preview: Preview, wishes: Wishes) -> None:
    """Keep all recordings and explorations of a preview, and note what became of each; then nothing waits any more.

    Where somebody else has just begun to, it is left to them.
    """
    with state.previews.taken(preview) as mine:
        if mine is None:
            return
        with open_store(mine.place, mine.blobs, durable=False, make=False) as scratch:
            digests = [one["digest"] for one in mine.found() if one["digest"] is not None]
            seen = recordings_of_digests(state.store, who.viewer, digests)
            waiting = _Waiting(scratch, mine, wishes, who, seen)
            outcomes = list(import_paths(state.store, [mine.place], [waiting], uploader=who.name))
            # their recordings are there by now
            episodes = list(_keep_episodes(state, who, mine, scratch, wishes))
        # what was found wrong when it was read stands on the page before, which is gone now
        before = [one for one in mine.found() if one["fate"] in (Fate.REFUSED.value, Fate.SKIPPED.value)]
        mine.note_kept([*before, *(_noted(outcome, seen) for outcome in outcomes), *episodes])


def _keep_episodes(
    state: State, who: Account, preview: Preview, scratch: Store, wishes: Wishes
) -> Iterator[dict[str, Any]]:
    told = {one["episode"]["id"]: one for one in preview.found() if one["episode"] is not None}
    for key, one in told.items():
        noted = {"source": one["source"], "fate": Fate.REFUSED.value, "reason": None}
        try:
            id, is_new = keep_whole(state, who, wishes.of(get_episode(scratch, UUID(key))))
        except UnavailableError:
            raise
        except StoreError as error:
            yield {**noted, "reason": str(error)}
            continue
        fate = Fate.NEW if is_new else Fate.KNOWN
        yield {**noted, "fate": fate.value, "episode": str(id), "told": f"Exploration of {one['episode']['thing']}"}


def _noted(outcome: Outcome, seen: Collection[str]) -> dict[str, Any]:
    """What became of a recording, as it is told on a page that can be loaded again.

    What others have sent is new to who does not see it; an administrator does, whoever it is of.
    """
    recording = outcome.recording
    is_known = outcome.fate is Fate.NEW and recording is not None and recording.digest in seen
    fate = Fate.KNOWN if is_known else outcome.fate
    told = {} if recording is None else {"digest": recording.digest, "told": _words(recording)}
    return {"source": outcome.source, "fate": fate.value, "reason": outcome.reason, **told}


def _words(recording: Recording) -> str:
    action = recording.action[:1].upper() + recording.action[1:]
    return f"{action} of {recording.thing.common_name or recording.thing.id}"
