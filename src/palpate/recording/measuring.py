"""What all recordings of one function have in common, and how each begins and ends."""

from __future__ import annotations

import logging
import platform
import re
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache, cached_property
from pathlib import Path
from typing import Any

from palpate.recording.capture import hearing
from palpate.recording.errors import RecordingError
from palpate.recording.recorder import Recorder, recording_here
from palpate.recording.results import OUTCOME, entries_of, exact_outcome
from palpate.recording.setups import read_setup
from palpate.recording.spool import Spool, Unfinished
from palpate.recording.watching import Finished, tell_finished
from palpate.store.checks import check, check_entry
from palpate.store.entries import Entry, FailedEntry
from palpate.store.errors import StoreError
from palpate.store.importing.folder import FolderWriter
from palpate.store.records import FileItem, Recording, Setup, ThingRef

__all__ = ["UNNAMED", "About", "Measuring", "Returned", "WhichThing"]

WhichThing = ThingRef | Callable[..., ThingRef] | None

UNNAMED = ThingRef("unnamed", "unnamed")
"""The object of a measurement that names none."""

_log = logging.getLogger("palpate.recording")

EXPECTED = 'what Outcome makes, as Outcome.normal("mass", 118.0, unit="g"), an outcome of robots, or None'


@cache
def _this_program() -> str:
    from importlib.metadata import version

    return f"palpate {version('palpate')}, Python {platform.python_version()}"


@dataclass(frozen=True)
class About:
    """Whose recordings they are and what made them.

    Attributes
    ----------
    owner, licence, visibility
        Whose they are and who may see them: private, lab or public.
    ground_truth
        Whether the results are known to be true, as from a scale.
    software, repository
        Version and address of the program that measures.
    """

    owner: str | None = None
    licence: str | None = None
    visibility: str = "private"
    ground_truth: bool = False
    software: str = field(default_factory=_this_program)
    repository: str | None = None


@dataclass
class Returned:
    """Where the result of a call is put."""

    value: object = None


@dataclass(frozen=True)
class Measuring:
    """What all recordings of one function have in common."""

    action: str
    setup: Setup | str | Path | None
    thing: WhichThing
    property: str
    about: About
    keywords: tuple[str, ...]
    given_spool: Spool | None

    @cached_property
    def spool(self) -> Spool:
        """Where recordings go, looked up at the first call."""
        return self.given_spool or Spool()

    @cached_property
    def devices(self) -> Setup:
        """The setup, read at the first call."""
        return self.setup if isinstance(self.setup, Setup) else read_setup(self.setup) if self.setup else Setup()

    @contextmanager
    def one(
        self, args: tuple[Any, ...], kwargs: dict[str, Any], *, superseded: Callable[[], bool] = lambda: False
    ) -> Iterator[Returned]:
        """Record one call; where in the end it is superseded by another recording, this one is dropped.

        Raises
        ------
        RecordingError
            If the disk does not take it. What the call itself raises goes on, and is recorded.
        """
        begun = self._begun(args, kwargs)
        returned = Returned()
        try:
            unfinished = self.spool.begin(begun)
        except OSError as error:
            raise _unwritable(self.spool, error) from error
        recorder = Recorder(unfinished.writer)
        try:
            with recording_here(recorder), hearing(recorder.hear):
                yield returned
        except BaseException as error:
            if superseded():
                self._drop(unfinished)
                raise
            recorder.hear(traceback.format_exc())
            failed = FailedEntry(": ".join(filter(None, (type(error).__name__, str(error)))))
            try:
                self._finish(unfinished, recorder, (failed,), ())
            except RecordingError as lost:
                error.add_note(str(lost))
            raise
        if superseded():
            self._drop(unfinished)
            return
        entries, notices = entries_of(returned.value, self.property)
        if not entries:
            for notice in notices:
                _log.warning("%s: %s; expected %s", self.action, notice, EXPECTED)
        self._finish(unfinished, recorder, entries, notices, exact_outcome(self.action, returned.value, entries))

    def _begun(self, args: tuple[Any, ...], kwargs: dict[str, Any]) -> Recording:
        thing = self.thing(*args, **kwargs) if callable(self.thing) else self.thing
        if not (thing is None or isinstance(thing, ThingRef)):
            raise RecordingError(f"{self.action}: the function of thing= returned {thing!r}, expected a ThingRef")
        begun = Recording(
            recorded_at=datetime.now(UTC),
            action=self.action,
            thing=thing or UNNAMED,
            setup=self.devices,
            **vars(self.about),
        )
        # whatever is wrong with these is found before the robot moves
        check(begun)
        return begun

    def _finish(
        self,
        unfinished: Unfinished,
        recorder: Recorder,
        entries: tuple[Entry, ...],
        notices: tuple[str, ...],
        outcome: bytes | None = None,
    ) -> None:
        """Keep the result and acknowledge the recording; RecordingError where the disk takes no more."""
        writer = unfinished.writer
        try:
            entries, notices = _kept(writer.recording, entries, notices)
            if writer.recording.thing == UNNAMED:
                notices = (*notices, "no object was named")
            if outcome is not None and OUTCOME not in {item.name for item in writer.recording.files}:
                writer.add_file(FileItem(OUTCOME, "application/json", outcome))
            for keyword in self.keywords:
                _keep_lines(writer, keyword, recorder.lines(keyword))
            try:
                recorder.close()
            except OSError:
                # the log is not whole, and the result is kept for whoever recovers the rest
                writer.update(entries=entries, notices=notices)
                raise
            recording = self.spool.finish(unfinished, entries=entries, notices=notices)
        except OSError as error:
            raise _unwritable(self.spool, error) from error
        finally:
            # after a failure what is there stays, to be recovered
            self.spool.abandon(unfinished)
        tell_finished(Finished(self.spool, unfinished.name, recording))

    def _drop(self, unfinished: Unfinished) -> None:
        try:
            self.spool.drop(unfinished)
        except OSError as error:
            _log.warning("%s stays in the spool: %s", unfinished.name, error)


def _keep_lines(writer: FolderWriter, keyword: str, lines: list[str]) -> None:
    """Keep lines of the log as a file, under a name that is free."""
    name = re.sub(r"[^A-Za-z0-9_-]+", "_", keyword).strip("_") or "lines"
    while f"log/{name}.txt" in {item.name for item in writer.recording.files}:
        name += "_"
    text = "".join(line + "\n" for line in lines)
    writer.add_file(FileItem(f"log/{name}.txt", "text/plain", text.encode()))


def _kept(recording: Recording, entries: tuple[Entry, ...], notices: tuple[str, ...]) -> tuple[Any, tuple[str, ...]]:
    """The entries where a store would have them; a failed one, and why, where it would not."""
    if not entries:
        return entries, notices
    try:
        # all else was checked when it came
        for place, entry in enumerate(entries):
            check_entry(f"entries[{place}]", entry, {})
    except StoreError as error:
        _log.warning("the result of %s is kept as failed: %s", recording.action, error)
        return (FailedEntry(f"the result was refused: {error}"),), (*notices, f"the result was {entries!r}")
    return entries, notices


def _unwritable(spool: Spool, error: OSError) -> RecordingError:
    where = error.filename or spool.folder
    return RecordingError(
        f"{where}: {error.strerror or error}: the recording is not whole, expected a disk that takes it"
    )
