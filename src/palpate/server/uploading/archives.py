"""What an archive that is uploaded holds beside recordings: explorations are taken, what is said of objects is told."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palpate.errors import LogError, plural
from palpate.server.explorations import check_whole
from palpate.server.receiving import check_owner
from palpate.server.security.accounts import Account
from palpate.store.archive_things import archived_thing
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import StoreError
from palpate.store.importing.archive_more import episodes_in, objects_in
from palpate.store.importing.items import Fate, Outcome
from palpate.store.keeping_episodes import put_episode
from palpate.store.store import Store
from palpate.store.things import Thing

__all__ = ["EpisodeOutcome", "more_of"]

FEW = 5
INSTEAD = "say it on the pages of the objects, or let who runs the server take it over by `palpate store import`"


@dataclass(frozen=True, eq=False)
class EpisodeOutcome(Outcome):
    """What became of an exploration; `episode` is None where none could be read."""

    episode: StoredEpisode | None = None

    def plain(self) -> dict[str, Any] | None:
        """What a preview shows of it."""
        if self.episode is None:
            return None
        one = self.episode
        until = one.embargoed_until
        return {
            "id": str(one.id),
            "dataset": one.thing.dataset,
            "thing": one.thing.id,
            "started_at": one.started_at.isoformat(),
            "actions": one.actions,
            "stop": one.stop,
            "owner": one.owner,
            "visibility": one.visibility,
            "embargoed_until": None if until is None else until.isoformat(),
        }


def more_of(folder: Path, store: Store, who: Account) -> Iterator[Outcome]:
    """Put the explorations of an archive into a store that has its recordings; tell what else is not taken."""
    for key, episode in episodes_in(folder):
        yield _read(store, f"{folder}: episode {key}", episode, who)
    yield from _objects(folder)


def _read(store: Store, source: str, episode: StoredEpisode | str, who: Account) -> Outcome:
    try:
        if isinstance(episode, str):
            raise StoreError(episode)
        check_owner(episode, who)
        check_whole(episode)
        receipt = put_episode(store, episode)
    except (LogError, StoreError, RecursionError) as error:
        return EpisodeOutcome(source, Fate.REFUSED, str(error))
    return EpisodeOutcome(source, Fate.NEW if receipt.new else Fate.KNOWN, episode=episode)


def _objects(folder: Path) -> Iterator[Outcome]:
    """What is said of objects, and by no recording of them."""
    things = [thing for thing in map(archived_thing, objects_in(folder)) if _says_more(thing)]
    if not things:
        return
    known = sum(len(thing.known) for thing in things)
    images = sum(len(thing.images) for thing in things)
    merges = sum(thing.merged_into is not None for thing in things)
    counts = ((known, "known value"), (images, "picture"), (merges, "merge"))
    told = ", ".join(plural(count, noun) for count, noun in counts if count)
    names = ", ".join(thing.path for thing in things[:FEW])
    more = f" and {len(things) - FEW} more" if len(things) > FEW else ""
    yield Outcome(
        f"{folder}: objects", Fate.SKIPPED, f"{told} of {names}{more}: nothing of that is taken here; {INSTEAD}"
    )


def _says_more(thing: Thing) -> bool:
    return bool(thing.known or thing.images or thing.merged_into)
