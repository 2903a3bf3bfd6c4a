"""Reads an upload in a process of its own, which has only so much memory and time: ``python -m`` with its folder.

Whoever uploads decides what the importers read. A file that makes one of them take too much ends this process, and not
the server.
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from palpate.server.receiving import wrong_owner
from palpate.server.security.accounts import Account, Role
from palpate.server.uploading.archives import EpisodeOutcome, more_of
from palpate.server.uploading.limits import limit_process
from palpate.server.uploading.maps import Maps
from palpate.server.uploading.preview import FOUND, OF_OTHERS, TASK, Preview
from palpate.store.errors import StoreError
from palpate.store.importing.finding import UNKNOWN
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Format, HoldsMore, Item, Outcome
from palpate.store.opening import open_store
from palpate.store.records import Recording
from palpate.store.store import Store
from palpate.store.units import take_units

__all__ = ["main"]

MOST_ITEMS = 5_000


class Theirs:
    """A format whose explorations are not those of somebody else than the account that uploads."""

    def __init__(self, inner: Format, who: Account) -> None:
        self._format = inner
        self._who = who

    def owns(self, path: Path) -> bool:
        """As the format says."""
        return self._format.owns(path)

    def count(self, path: Path) -> int:
        """As the format says."""
        return self._format.count(path)

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """The items; whether what is in the name of somebody else is refused depends on what the server has."""
        for item in self._format.items(path):
            yield item if isinstance(item, Outcome) else Item(item.source, partial(_read, item))

    def put_more(self, path: Path, store: Store) -> Iterator[Outcome]:
        """What an archive holds beside recordings; nothing of other formats."""
        yield from more_of(path, store, self._who) if isinstance(self._format, HoldsMore) else ()


def _read(item: Item) -> Recording:
    try:
        return item.read()
    except (MemoryError, OverflowError):
        raise StoreError("holds more, or larger numbers, than can be read here") from None


def _read_all(preview: Preview, task: dict[str, Any], who: Account) -> Iterator[Outcome]:
    maps = Maps.taken_from(preview.sent)
    yield from maps.refused
    formats = [Theirs(one, who) for one in all_formats(maps.columns, maps.topics)]
    with open_store(preview.place, preview.blobs, durable=False) as store:
        take_units(store, task["units"])
        for count, outcome in enumerate(import_paths(store, [preview.sent], formats)):
            if count >= MOST_ITEMS:
                yield Outcome("more", Fate.REFUSED, f"more than {MOST_ITEMS} items, expected fewer in one upload")
                return
            yield _looked_into(replace(outcome, reason=maps.told(outcome.reason)))


def _looked_into(outcome: Outcome) -> Outcome:
    """The same, and of a JSON file that nothing could be made of whether it is any."""
    if outcome.reason != UNKNOWN or not outcome.source.lower().endswith(".json"):
        return outcome
    try:
        json.loads(Path(outcome.source).read_bytes())
    except (ValueError, RecursionError) as error:
        return Outcome(outcome.source, outcome.fate, f"is no JSON: {error}")
    return outcome


def _plain(outcome: Outcome, hidden: str, who: Account) -> dict[str, Any]:
    reason = None if outcome.reason is None else " ".join(outcome.reason.replace(f"{hidden}/", "").split())
    digest = None if outcome.recording is None or outcome.fate is Fate.REFUSED else outcome.recording.digest
    source = outcome.source.removeprefix(f"{hidden}/").removeprefix(hidden)
    episode = outcome.plain() if isinstance(outcome, EpisodeOutcome) else None
    plain = {"source": source, "fate": outcome.fate.value, "reason": reason, "digest": digest, "episode": episode}
    wrong = None if digest is None or outcome.recording is None else wrong_owner(outcome.recording, who)
    return plain if wrong is None else {**plain, OF_OTHERS: wrong}


def main(folder: Path) -> None:
    """Read what lies in a preview, and leave beside it what became of each item."""
    limit_process()
    preview = Preview(folder.name, folder)
    task = json.loads((folder / TASK).read_text(encoding="utf-8"))
    who = Account(task["account"], Role[task["role"]])
    found = [_plain(outcome, str(preview.sent), who) for outcome in _read_all(preview, task, who)]
    (folder / FOUND).write_text(json.dumps([*task["refused"], *found]), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]))
