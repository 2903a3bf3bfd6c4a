"""Explorations that are on their way to a server: each line is in a file before it is sent.

The folder ``episodes`` of a spool holds a file for each exploration that the server does not have whole: its beginning,
then its lines. A file goes when the server has all of it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any
from uuid import UUID

from palpate.recording.errors import RecordingError
from palpate.recording.lock import Lock, locked
from palpate.recording.spool import Spool
from palpate.store.content import in_utc, to_json
from palpate.store.decoding import moment_from
from palpate.store.episodes import StoredEpisode, StoredStep
from palpate.store.errors import DamagedError
from palpate.store.legible import legible
from palpate.store.records import ThingRef

__all__ = ["Outbox", "Outgoing"]


class Outbox:
    """The explorations of a spool that no server has whole.

    Parameters
    ----------
    spool
        Where recordings wait.
    """

    def __init__(self, spool: Spool) -> None:
        self._spool = spool
        self.folder = spool.folder / "episodes"

    def begin(self, episode: StoredEpisode) -> Outgoing:
        """Keep the beginning of an exploration; its lines follow.

        Raises
        ------
        RecordingError
            If it is being sent already, or the disk does not take it.
        """
        (self._spool.folder / "locks").mkdir(parents=True, exist_ok=True)
        self.folder.mkdir(exist_ok=True)
        path, lock = self._path(str(episode.id)), Lock(self._lock(str(episode.id)))
        if not lock.take():
            raise RecordingError(f"{self.folder}: {episode.id} is being sent already, expected an id of its own")
        if path.exists():
            lock.leave()
            raise RecordingError(f"{self.folder}: {episode.id} waits there already, expected an id of its own")
        outgoing = Outgoing(path, lock)
        try:
            outgoing.write(_beginning(episode))
            for step in episode.steps:
                outgoing.add(step)
        except RecordingError:
            # nothing has begun
            outgoing.leave(is_sent=True)
            raise
        return outgoing

    def waiting(self) -> list[str]:
        """Ids of the explorations that are here."""
        return sorted(path.stem for path in self.folder.glob("*.jsonl")) if self.folder.is_dir() else []

    def read(self, name: str) -> StoredEpisode:
        """One of them, as far as it was written; a line that a kill has cut off is left out.

        Raises
        ------
        DamagedError
            If it cannot be read.
        """
        path = self._path(name)
        with legible(str(path)):
            # what is behind the last line end was being written when the program was killed
            whole = [json.loads(row) for row in path.read_text(encoding="utf-8").split("\n")[:-1]]
            if not whole:
                raise DamagedError(f"{path}: is empty, expected the beginning of an exploration")
            return _episode(*whole)

    @contextmanager
    def claimed(self, name: str) -> Iterator[bool]:
        """Keep others from sending one; what it gives tells whether it is there and was free."""
        with locked(self._lock(name)) as taken:
            yield taken and self._path(name).is_file()

    def remove(self, name: str) -> None:
        """Remove one that a server has; it must be claimed."""
        self._path(name).unlink()

    def _path(self, name: str) -> Path:
        return self.folder / f"{name}.jsonl"

    def _lock(self, name: str) -> Path:
        return self._spool.folder / "locks" / f"episode-{name}"


class Outgoing:
    """One exploration that is being written: nobody else sends it meanwhile."""

    def __init__(self, path: Path, lock: Lock) -> None:
        self.path = path
        self._lock = lock
        self._whole_bytes = 0

    def add(self, step: StoredStep) -> None:
        """Keep a line; RecordingError where the disk does not take it."""
        self.write({"record": step.record, "recording": step.recording})

    def write(self, plain: Any) -> None:
        """Keep a line as JSON, whole or not at all; a line that a full disk has cut off is no beginning of the next.

        Raises
        ------
        RecordingError
            If the disk does not take it.
        """
        data = (to_json(plain) + "\n").encode()
        try:
            with self.path.open("r+b" if self._whole_bytes else "xb", buffering=0) as file:
                self._append(file, data)
        except OSError as error:
            raise RecordingError(f"{self.path} cannot be written: {error.strerror or error}") from error
        self._whole_bytes += len(data)

    def _append(self, file: IO[bytes], data: bytes) -> None:
        file.truncate(self._whole_bytes)
        file.seek(self._whole_bytes)
        try:
            rest = memoryview(data)
            while rest:
                rest = rest[file.write(rest) :]
        except OSError:
            # where that fails too, the next line does it
            with suppress(OSError):
                file.truncate(self._whole_bytes)
            raise

    def leave(self, *, is_sent: bool) -> None:
        """Let others have it, or nobody where the server has it whole."""
        if is_sent:
            with suppress(FileNotFoundError):
                self.path.unlink()
        self._lock.leave()


def _beginning(episode: StoredEpisode) -> dict[str, Any]:
    thing, embargo = episode.thing, episode.embargoed_until
    return {
        "id": str(episode.id),
        "started_at": in_utc(episode.started_at),
        "thing": [thing.dataset, thing.id, thing.common_name],
        "owner": episode.owner,
        "visibility": episode.visibility,
        "embargoed_until": None if embargo is None else in_utc(embargo),
        "header": episode.header,
    }


def _episode(head: Any, *lines: Any) -> StoredEpisode:
    dataset, id, common_name = head["thing"]
    embargo = head["embargoed_until"]
    return StoredEpisode(
        started_at=moment_from(head["started_at"]),
        thing=ThingRef(dataset, id, common_name=common_name),
        header=head["header"],
        steps=tuple(StoredStep(line["record"], line["recording"]) for line in lines),
        owner=head["owner"],
        visibility=head["visibility"],
        embargoed_until=None if embargo is None else moment_from(embargo),
        id=UUID(head["id"]),
    )
