"""What a measurement tells about itself while it runs."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from palpate.errors import choices, near
from palpate.network.units import factor
from palpate.recording.contents import Content, content_of, json_of
from palpate.recording.errors import RecordingError
from palpate.store.checks import check
from palpate.store.entries import Entry
from palpate.store.importing.folder import FolderWriter
from palpate.store.importing.paths import check_name, media_type_of
from palpate.store.records import Channel, FileItem, Pose, Recording, Series, ThingRef

__all__ = ["Recorder", "current_recording", "recording_here"]

_current: ContextVar[Recorder | None] = ContextVar("palpate_recorder", default=None)


class Recorder:
    """Keeps what the current measurement wants to have kept; `current_recording` gives it.

    All of it is in the spool when the method returns. What cannot be kept is refused at once, in
    a sentence that names it.
    """

    def __init__(self, writer: FolderWriter) -> None:
        self._writer = writer
        self._begun = writer.recording
        self._process = os.getpid()
        self._guard = threading.RLock()
        self._is_over = False
        self._lost: OSError | None = None

    def series(
        self,
        name: str,
        *,
        time: ArrayLike | None = None,
        rate_hz: float | None = None,
        units: Mapping[str, str] | None = None,
        quantities: Mapping[str, str] | None = None,
        **channels: ArrayLike,
    ) -> None:
        """Keep the samples that a device gave.

        Parameters
        ----------
        name
            The device, or whatever tells the series from others of the recording.
        time
            Time stamps, (n), in the unit ``units["time"]``, seconds unless given.
        rate_hz
            Samples per second where they are evenly spaced.
        units
            Channel to its unit; nobody is taken to have stated the unit of one that is not there.
        quantities
            Channel to what it holds; the channel's name unless given.
        channels
            Samples, (n, ...).

        Raises
        ------
        StoreError
            If the channels do not fit together, or a unit is unknown or of another dimension.
        RecordingError
            If a unit or a quantity is for a channel that is not there, or time stamps go back.
        """
        units, quantities = dict(units or {}), dict(quantities or {})
        for given in (*units, *quantities):
            if given not in channels and given != "time":
                found = f"series {name!r}: {given!r}{near(given, channels)} is no channel"
                raise RecordingError(f"{found}; {choices(channels)}")
        time_s = None if time is None else np.asarray(time, dtype=np.float64) * factor(units.pop("time", "s"), "s")
        kept = tuple(
            Channel(channel, quantities.get(channel, channel), units.get(channel), np.asarray(values), rate_hz, time_s)
            for channel, values in channels.items()
        )
        self.add_series(Series(name, kept))

    def add_series(self, series: Series) -> None:
        """Keep a series whose channels have rates or time stamps of their own."""
        with self._open(series=(series,)) as writer:
            _check_forward(series)
            writer.add_series(series)

    def file(self, name: str, content: Content, *, media_type: str | None = None) -> None:
        """Keep a file.

        Parameters
        ----------
        name
            A relative path with forward slashes, such as ``"imgs/cam0.png"``.
        content
            Bytes, text, the path of a file to copy, a picture (an array of uint8 or uint16, kept as PNG), or a figure.
        media_type
            What it is; told by the name's ending unless given.
        """
        name = check_name(name, f"file {name!r}")
        item = FileItem(name, media_type or media_type_of(name), content_of(name, content))
        with self._open(files=(item,)) as writer:
            writer.add_file(item)

    def variable(self, name: str, value: object) -> None:
        """Keep a value that JSON can hold, as the file ``data/<name>.json``."""
        self.file(f"data/{name}.json", json_of(f"variable {name!r}", value))

    def thing(self, thing: ThingRef) -> None:
        """Tell which object is measured.

        Raises
        ------
        RecordingError
            If it is no `ThingRef`.
        """
        if not isinstance(thing, ThingRef):
            raise RecordingError(f"thing: found {thing!r}, expected a ThingRef")
        self._update(thing=thing)

    def object_pose(self, pose: Pose) -> None:
        """Tell where the object is."""
        self._update(object_pose=pose)

    def gripper_pose(self, pose: Pose) -> None:
        """Tell where the gripper is."""
        self._update(gripper_pose=pose)

    def grasp(self, grasp: Mapping[str, Any]) -> None:
        """Tell how the object is held, in words of your own."""
        self._update(grasp=dict(grasp))

    def entry(self, *entries: Entry) -> None:
        """Keep results beside the one that the measurement returns."""
        self._update(entries=entries)

    def notice(self, *texts: str) -> None:
        """Keep what was odd, for people to read."""
        self._update(notices=texts)

    @property
    def log(self) -> str:
        """What was printed and logged so far."""
        return self._writer.log

    @property
    def recording(self) -> Recording:
        """What is kept so far, without the log."""
        return self._writer.recording

    def lines(self, keyword: str) -> list[str]:
        """Lines of the log that hold a keyword."""
        return [line for line in self.log.splitlines() if keyword in line]

    def hear(self, text: str) -> None:
        """Add to the log; what a full disk does not take is told by `close`, as printing must not fail."""
        with self._guard:
            if self._is_over or self._lost:
                return
            try:
                self._writer.write_log(text)
            except OSError as error:
                self._lost = error

    def close(self) -> None:
        """Take nothing more; OSError where a part of the log could not be written."""
        with self._guard:
            self._is_over = True
            if self._lost:
                raise self._lost

    def _update(self, **fields: Any) -> None:
        with self._open(**fields) as writer:
            writer.update(**fields)

    @contextmanager
    def _open(self, **fields: Any) -> Iterator[FolderWriter]:
        """The writer, once the fields are found to be such as a store keeps."""
        if self._process != os.getpid():
            raise RecordingError("the recording belongs to another process, expected a recording of this one")
        with self._guard:
            if self._is_over:
                raise RecordingError("the recording is over, expected a measurement that is still running")
            for kind in ("series", "files"):
                names = {one.name for one in getattr(self.recording, kind)}
                for one in fields.get(kind, ()):
                    if one.name in names:
                        raise RecordingError(f"{kind}: a second {one.name!r}, expected names of their own")
            # what is there was checked when it came
            check(replace(self._begun, **fields))
            yield self._writer


def _check_forward(series: Series) -> None:
    """Refuse time stamps that go back, as an import of tables does; nobody knows which samples they belong to."""
    for channel in series.channels:
        times = channel.time_s
        if times is None:
            continue
        back = np.flatnonzero(np.diff(times) < 0)
        if back.size:
            place = int(back[0]) + 1
            found = f"time stamp {place} is {times[place]:g} s, after {times[place - 1]:g} s"
            raise RecordingError(f"series {series.name!r}, channel {channel.name!r}: {found}; expected none to go back")


def current_recording() -> Recorder:
    """Return the recorder of the measurement that this code is part of.

    A thread that a measurement starts is part of it where it runs in a copy of its context
    (`contextvars.copy_context`); tasks of asyncio are by themselves.

    Raises
    ------
    RecordingError
        If no recording is going on here.
    """
    found = _current.get()
    if found is None:
        raise RecordingError("no recording is going on here, expected a call from a function with @record")
    return found


@contextmanager
def recording_here(recorder: Recorder) -> Iterator[None]:
    """Make a recorder the current one in this context."""
    token = _current.set(recorder)
    try:
        yield
    finally:
        _current.reset(token)
