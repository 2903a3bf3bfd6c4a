"""Many recordings in one request: each is kept or refused by itself, and told about by itself."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from palpate.server.problems import FIELD
from palpate.server.receiving import check_owner, check_parts
from palpate.server.security.accounts import Account
from palpate.server.state import State
from palpate.store.errors import StoreError
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.importing.lines import recording_of
from palpate.store.importing.package import unpack
from palpate.store.records import Recording
from palpate.store.visible_episodes import recordings_of_digests

__all__ = ["LINES", "keep_batch"]

LINES = "recordings.ndjson"
"""Name of a file of lines; all others are packages."""
MOST_LINES = 10_000


def keep_batch(state: State, who: Account, files: list[Path]) -> list[dict[str, Any]]:
    """Keep the recordings of files of lines and of packages, and tell of each what became of it, in their order."""
    with TemporaryDirectory(prefix="palpate-upload-") as folder:
        form = Sent(state, who, Path(folder))
        outcomes = {outcome.source: outcome for outcome in import_paths(state.store, files, [form], uploader=who.name)}
        digests = [one.recording.digest for one in outcomes.values() if one.recording is not None]
        ids = recordings_of_digests(state.store, who.viewer, digests)
        order = sorted(outcomes.values(), key=lambda one: form.places.get(one.source, (len(files), 0)))
        hidden = [folder, *(str(file.parent) for file in files)]
        return [_told(one, ids, hidden) for one in order]


@dataclass
class Sent:
    """What came in one request, as a format of imports."""

    state: State
    who: Account
    folder: Path
    places: dict[str, tuple[int, int]] = field(default_factory=dict)

    def owns(self, path: Path) -> bool:
        """All files are of it."""
        return path.is_file()

    def count(self, path: Path) -> int:
        """Nobody watches how far it is."""
        return 1

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """A recording for each line, or one for the package."""
        number = len({file for file, _ in self.places.values()})
        if path.name != LINES:
            self.places[path.name] = (number, 0)
            yield Item(path.name, partial(self._package, path, number))
            return
        with path.open("rb") as opened:
            for place, line in enumerate(opened, 1):
                if place > MOST_LINES:
                    raise StoreError(f"line {place}: is one too many, expected {MOST_LINES} at most")
                if line.strip():
                    self.places[f"line {place}"] = (number, place)
                    yield Item(f"line {place}", partial(self._line, line))

    def _line(self, line: bytes) -> Recording:
        return self._theirs(recording_of(line))

    def _package(self, path: Path, number: int) -> Recording:
        def folder() -> Path:
            made = self.folder / str(number)
            made.mkdir()
            return made

        with path.open("rb") as opened:
            check_parts(opened)
            try:
                largest = self.state.settings.largest_unpacked_bytes
                return self._theirs(unpack(opened, folder, largest_bytes=largest))
            except (MemoryError, OverflowError):
                raise StoreError("package: holds numbers that are too large") from None

    def _theirs(self, recording: Recording) -> Recording:
        check_owner(recording, self.who)
        return recording


def _told(outcome: Outcome, ids: Any, hidden: list[str]) -> dict[str, Any]:
    """What became of one: a status as a request of its own would have had."""
    told: dict[str, Any] = {"source": outcome.source}
    if outcome.recording is None or outcome.fate is Fate.REFUSED:
        reason = " ".join((outcome.reason or "is refused").split())
        for folder in hidden:
            reason = reason.replace(f"{folder}/", "").replace(folder, "package")
        found = FIELD.fullmatch(reason)
        errors = [{"field": found[1], "detail": found[2]}] if found else []
        return {**told, "status": 422, "id": None, "digest": None, "new": False, "detail": reason, "errors": errors}
    digest, new = outcome.recording.digest, outcome.fate is Fate.NEW
    id = ids.get(digest)
    told |= {"status": 201 if new else 200, "id": None if id is None else str(id), "digest": digest, "new": new}
    return {**told, "detail": None, "errors": []}
