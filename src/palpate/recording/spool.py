"""The spool: a plain folder where every recording is before it is anywhere else.

``open`` holds what is being recorded, and what is left of it where the program was killed; ``waiting`` holds whole
recordings that no store has yet; ``refused`` those that a store would not have, with the reason. A recording is a
folder that is renamed from one to the next once all of it is on the disk, and so is never seen in half. ``drafts`` and
``done`` are for what is being written and removed, ``locks`` for who is at work.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from datetime import UTC
from pathlib import Path
from typing import Any

from palpate.recording.errors import RecordingError
from palpate.recording.lock import Lock, locked
from palpate.store.durable import sync_folder, sync_tree
from palpate.store.errors import DamagedError, StoreError
from palpate.store.importing.folder import FolderWriter, write_folder
from palpate.store.importing.reading_folder import is_whole, read_folder, read_remainder, stated_digest
from palpate.store.records import Recording

__all__ = ["FOLDERS", "KILLED", "Spool", "Unfinished", "default_folder"]

KILLED = "the recording was cut off before its end"
"""The reason that stands in what is recovered."""

FOLDERS = ("open", "waiting", "refused", "drafts", "done", "locks")
"""What a spool consists of; a copy may lack those that are empty."""
REASON = "reason.txt"


def default_folder() -> Path:
    """Where the spool is unless told: ``PALPATE_SPOOL``, or ``palpate/spool`` among the user's data."""
    told = os.environ.get("PALPATE_SPOOL")
    if told:
        return Path(told)
    from platformdirs import user_data_path

    return user_data_path("palpate", appauthor=False) / "spool"


@dataclass(frozen=True, eq=False)
class Unfinished:
    """A recording that is being written, its name in the spool, and the lock that tells so."""

    name: str
    writer: FolderWriter
    lock: Lock


class Spool:
    """Recordings in a folder; several processes and threads may use one at the same time.

    Parameters
    ----------
    folder
        Made on first use; `default_folder` unless given.
    sync
        Whether to wait until each recording is on the disk; without it a power cut can lose the last ones.

    Examples
    --------
    >>> from datetime import UTC, datetime
    >>> from tempfile import TemporaryDirectory
    >>> from palpate.store.records import ThingRef
    >>> with TemporaryDirectory() as folder:
    ...     spool = Spool(folder)
    ...     name = spool.add(Recording(datetime(2024, 5, 1, tzinfo=UTC), "weighing", ThingRef("ycb", "025_mug")))
    ...     spool.read(name).action, spool.waiting() == [name]
    ('weighing', True)
    """

    def __init__(self, folder: str | Path | None = None, *, sync: bool = True) -> None:
        self.folder = default_folder() if folder is None else Path(folder)
        self.sync = sync
        self._is_made = False

    def begin(self, begun: Recording) -> Unfinished:
        """Begin a recording that is written as it comes; its series, files and log are empty.

        Raises
        ------
        RecordingError
            If one of this id is being written already.
        OSError
            If the disk does not take it.
        """
        name = _name(begun)
        lock = Lock(self._lock(name))
        # held before there is anything to recover
        if not lock.take():
            raise RecordingError(f"{self.folder}: {name} is being written already, expected an id of its own")
        folder = self._path("open", name)
        try:
            folder.mkdir()
            return Unfinished(name, FolderWriter(folder, begun), lock)
        except OSError:
            lock.leave()
            raise

    def finish(self, unfinished: Unfinished, **fields: Any) -> Recording:
        """Set the last fields and put the recording among those that wait; when this returns it is acknowledged."""
        try:
            writer = unfinished.writer
            recording = writer.end(sync=self.sync, **fields)
            self._rename(writer.folder, self._path("waiting", unfinished.name))
        finally:
            self.abandon(unfinished)
        return recording

    def abandon(self, unfinished: Unfinished) -> None:
        """Leave a recording as it is, to be recovered."""
        unfinished.writer.close()
        unfinished.lock.leave()

    def drop(self, unfinished: Unfinished) -> None:
        """Remove a recording that was begun, as another one says the same."""
        unfinished.writer.close()
        try:
            self._discard(unfinished.name, "open")
        finally:
            unfinished.lock.leave()

    def add(self, recording: Recording) -> str:
        """Put a whole recording among those that wait, and return its name there; the same again is the same one.

        Raises
        ------
        RecordingError
            If it is being written, or its id is that of another recording here.
        """
        name = _name(recording)
        with locked(self._lock(name)) as taken:
            if not taken:
                raise RecordingError(f"{self.folder}: {name} is being written already, expected an id of its own")
            if not self._has(name, recording):
                self._write(name, recording)
        return name

    def waiting(self) -> list[str]:
        """Names of the whole recordings that no store has yet, the oldest first."""
        return self._names("waiting")

    def refused(self) -> dict[str, str]:
        """Names of the recordings that a store would not have, and why."""
        names = self._names("refused")
        return {name: (self._path("refused", name) / REASON).read_text(encoding="utf-8").strip() for name in names}

    def unfinished(self) -> dict[str, bool]:
        """Names of the recordings that are not whole, and whether each is being recorded now."""
        found = {}
        for name in self._names("open"):
            with locked(self._lock(name)) as taken:
                found[name] = not taken
        return found

    def read(self, name: str) -> Recording:
        """Read one of the recordings that wait.

        Raises
        ------
        StoreError
            If it is not there or is damaged.
        """
        return read_folder(self._path("waiting", name))

    def recover(self) -> Iterator[tuple[str, Recording | StoreError]]:
        """Make what killed programs left behind recordings that wait.

        They are marked as failed, unless nothing but the last move was missing. What cannot be
        read stays where it is, and comes with the reason.
        """
        for name in self._names("open"):
            with locked(self._lock(name)) as taken:
                folder = self._path("open", name)
                if not (taken and folder.is_dir()):
                    continue
                try:
                    found = self._recover(name, folder)
                except StoreError as error:
                    yield name, error
                else:
                    if found is not None:
                        yield name, found

    @contextmanager
    def claimed(self, name: str) -> Iterator[bool]:
        """Keep others from sending a recording that waits; what it gives tells whether it is there and was free."""
        with locked(self._lock(name)) as taken:
            yield taken and self.waits(name)

    def waits(self, name: str) -> bool:
        """Whether a recording waits."""
        return self._path("waiting", name).is_dir()

    def remove(self, name: str) -> None:
        """Remove a recording that a store has acknowledged; it must be claimed."""
        self._discard(name, "waiting")

    def refuse(self, name: str, reason: str) -> None:
        """Set a recording aside that a store would not have; it must be claimed."""
        (self._path("waiting", name) / REASON).write_text(" ".join(reason.split()) + "\n", encoding="utf-8")
        self._move(name, "waiting", "refused")

    def requeue(self, name: str) -> None:
        """Let a recording that was refused wait again."""
        self._move(name, "refused", "waiting")

    def _recover(self, name: str, folder: Path) -> Recording | None:
        if is_whole(folder) and self._is_readable(folder):
            self._move(name, "open", "waiting")
            return self.read(name)
        if not any(path.stat().st_size for path in folder.iterdir()):
            # killed before the first line
            self._discard(name, "open")
            return None
        # killed after this and before the end, the same is done again: it gives the same digest
        if not self._path("waiting", name).is_dir():
            self._write(name, read_remainder(folder, KILLED))
        self._discard(name, "open")
        return self.read(name)

    def _is_readable(self, folder: Path) -> bool:
        """Whether all that a whole journal names is there, and on the disk; after a power cut it may not be."""
        try:
            read_folder(folder)
        except DamagedError:
            return False
        if self.sync:
            sync_tree(folder)
        return True

    def _has(self, name: str, recording: Recording) -> bool:
        """Whether a recording waits here; it does so again where it was refused."""
        for state in ("waiting", "refused"):
            folder = self._path(state, name)
            if not folder.is_dir():
                continue
            if stated_digest(folder) != recording.digest:
                raise RecordingError(f"{folder.parent}: {name} is another recording, expected an id of its own")
            if state == "refused":
                self.requeue(name)
            return True
        return False

    def _write(self, name: str, recording: Recording) -> None:
        draft = self._cleared("drafts", name)
        draft.mkdir()
        write_folder(recording, draft, sync=self.sync)
        self._move(name, "drafts", "waiting")

    def _discard(self, name: str, source: str) -> None:
        # moved first: a kill in the middle must not leave half a recording where whole ones are
        done = self._cleared("done", name)
        self._move(name, source, "done")
        shutil.rmtree(done)

    def _cleared(self, state: str, name: str) -> Path:
        """Return a path where what a killed program left is removed."""
        path = self._path(state, name)
        if path.exists():
            shutil.rmtree(path)
        return path

    def _move(self, name: str, source: str, target: str) -> None:
        self._rename(self._path(source, name), self._path(target, name))

    def _rename(self, source: Path, target: Path) -> None:
        source.rename(target)
        if self.sync:
            sync_folder(target.parent)
            sync_folder(source.parent)

    def _names(self, state: str) -> list[str]:
        folder = self.folder / state
        return sorted(path.name for path in folder.iterdir() if path.is_dir()) if folder.is_dir() else []

    def _make(self) -> None:
        if not self._is_made:
            for name in FOLDERS:
                (self.folder / name).mkdir(parents=True, exist_ok=True)
            self._is_made = True

    def _lock(self, name: str) -> Path:
        self._make()
        return self._path("locks", name)

    def _path(self, state: str, name: str) -> Path:
        # from one text: joining paths takes several times as long, and each recording needs several
        return Path(f"{self.folder}/{state}/{name}")


def _name(recording: Recording) -> str:
    """Its time and its id: names sort by time."""
    return f"{recording.recorded_at.astimezone(UTC):%Y%m%dT%H%M%S}-{recording.id}"
