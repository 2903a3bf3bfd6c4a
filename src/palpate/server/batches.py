"""Many recordings in one request: each is kept or refused by itself, and told about by itself."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO, Any

from palpate.server.problems import FIELD
from palpate.server.receiving import check_owner, unpacked
from palpate.server.security.accounts import Account
from palpate.server.state import State
from palpate.store.errors import StoreError
from palpate.store.importing.intake import import_items
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.importing.lines import recording_of
from palpate.store.records import Recording
from palpate.store.visible_episodes import recordings_of_digests

__all__ = ["keep_lines", "keep_packages"]

MOST_LINES = 10_000


def keep_lines(state: State, who: Account, body: IO[bytes]) -> list[dict[str, Any]]:
    """Keep the recordings of lines, and tell of each what became of it, in their order."""

    def read(line: bytes) -> Recording:
        return _theirs(recording_of(line), who)

    def items() -> Iterator[Item | Outcome]:
        for place, line in enumerate(body, 1):
            if place > MOST_LINES:
                told = f"is one too many, expected {MOST_LINES} at most"
                yield Outcome(f"line {place}", Fate.REFUSED, told)
                return
            if line.strip():
                yield Item(f"line {place}", partial(read, line))

    return _keep(state, who, items())


def keep_packages(state: State, who: Account, parts: Sequence[IO[bytes]]) -> list[dict[str, Any]]:
    """Keep the recordings of packages likewise; names that somebody sends are no names of ours."""
    with TemporaryDirectory(prefix="palpate-upload-") as name:

        def read(place: int) -> Recording:
            return _theirs(_unpacked(parts[place - 1], Path(name, str(place)), state), who)

        items = (Item(f"package {place}", partial(read, place)) for place in range(1, len(parts) + 1))
        return _keep(state, who, items, hidden=name)


def _keep(
    state: State, who: Account, items: Iterator[Item | Outcome], hidden: str | None = None
) -> list[dict[str, Any]]:
    order = list[str]()

    def noted() -> Iterator[Item | Outcome]:
        for item in items:
            order.append(item.source)
            yield item

    outcomes = {outcome.source: outcome for outcome in import_items(state.store, noted(), who.name)}
    digests = [one.recording.digest for one in outcomes.values() if one.recording is not None]
    ids = recordings_of_digests(state.store, who.viewer, digests)
    return [_told(outcomes[source], ids, hidden) for source in order]


def _unpacked(package: IO[bytes], folder: Path, state: State) -> Recording:
    def made() -> Path:
        folder.mkdir()
        return folder

    try:
        return unpacked(state, package, made)
    except (MemoryError, OverflowError):
        raise StoreError("package: holds numbers that are too large") from None


def _theirs(recording: Recording, who: Account) -> Recording:
    check_owner(recording, who)
    return recording


def _told(outcome: Outcome, ids: Any, hidden: str | None) -> dict[str, Any]:
    """What became of one: a status as a request of its own would have had."""
    told: dict[str, Any] = {"source": outcome.source}
    if outcome.recording is None or outcome.fate is Fate.REFUSED:
        reason = " ".join((outcome.reason or "is refused").split())
        if hidden is not None:
            reason = reason.replace(f"{hidden}/", "").replace(hidden, "package")
        found = FIELD.fullmatch(reason)
        errors = [{"field": found[1], "detail": found[2]}] if found else []
        return {
            **told,
            "status": 422,
            "id": None,
            "digest": None,
            "new": False,
            "detail": reason,
            "errors": errors,
            "notices": [],
        }
    digest, new = outcome.recording.digest, outcome.fate is Fate.NEW
    id = ids.get(digest)
    told |= {"status": 201 if new else 200, "id": None if id is None else str(id), "digest": digest, "new": new}
    return {**told, "detail": None, "errors": [], "notices": list(outcome.implausible)}
