"""A recording as a plain folder: a journal of JSON lines, arrays as .npy, the log as text, files as they are.

The journal grows while the measurement runs, and its last line says that the recording is whole and what its digest
is. Each line names the arrays and files that were written before it, with their checksums: whatever ends the program
leaves a folder of which everything up to the last whole line can be read.
"""

from __future__ import annotations

import re
import shutil
from dataclasses import replace
from functools import lru_cache
from io import BytesIO, FileIO
from pathlib import Path, PurePosixPath
from typing import Any
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from palpate.store.content import canonical_array, to_json
from palpate.store.durable import sync_tree
from palpate.store.importing.plain import FIELDS, encode, updated
from palpate.store.records import Channel, FileItem, Recording, Series

__all__ = ["FORMAT", "JOURNAL", "LOG", "FolderWriter", "checksum", "write_folder"]

FORMAT = "palpate-recording/1"
JOURNAL = "journal.jsonl"
LOG = "log.txt"


class FolderWriter:
    """Writes one recording as it comes.

    Parameters
    ----------
    folder
        An existing folder with nothing of this format in it.
    begun
        What is known when the measurement begins: a recording without series, files and log.
    """

    def __init__(self, folder: Path, begun: Recording) -> None:
        self.folder = folder
        self.recording = begun
        self._written = 0
        self._log: list[bytes] = []
        self._log_file: FileIO | None = None
        # unbuffered, one write a line: whatever kills the process, a line is there or it is not
        self._journal = self._opened(JOURNAL)
        self._line({"format": FORMAT, **encode({name: getattr(begun, name) for name in FIELDS})})

    def update(self, **fields: Any) -> None:
        """Set fields of the recording; entries and notices come after those that are there."""
        self._line(encode(fields))
        self.recording = updated(self.recording, fields)

    def add_series(self, series: Series) -> None:
        """Add a series; its arrays are copied."""
        kept = replace(series, channels=tuple(map(_copied, series.channels)))
        self.write_series(kept)
        self.recording = replace(self.recording, series=(*self.recording.series, kept))

    def write_series(self, series: Series) -> None:
        """Write a series of a recording that need not fit into memory, and forget it: such a one ends by `end_as`."""
        plain = []
        for channel in series.channels:
            about = {name: getattr(channel, name) for name in ("name", "quantity", "unit")}
            rate_hz = None if channel.rate_hz is None else float(channel.rate_hz)
            arrays = {name: self._array(getattr(channel, name)) for name in ("values", "time_s")}
            plain.append({**about, "rate_hz": rate_hz, **arrays})
        self._line({"series": {"name": series.name, "channels": plain}})

    def add_file(self, item: FileItem) -> None:
        """Add a file; it is copied."""
        path = self.folder / self._new_name("-" + _plain_name(item.name))
        if isinstance(item.data, bytes):
            path.write_bytes(item.data)
        else:
            shutil.copyfile(item.data, path)
        about = {"name": item.name, "media_type": item.media_type}
        self._line({"file": {**about, "path": path.name, "crc32": checksum(path)}})
        self.recording = replace(self.recording, files=(*self.recording.files, replace(item, data=path)))

    def write_log(self, text: str) -> None:
        """Add to the log."""
        # half a surrogate pair can be printed, and can be kept only as an escape
        line = text.encode("utf-8", "backslashreplace")
        if self._log_file is None:
            self._log_file = self._opened(LOG)
        _write_all(self._log_file, line)
        self._log.append(line)

    @property
    def log(self) -> str:
        """What was logged so far."""
        return b"".join(self._log).decode()

    def end(self, *, sync: bool = True, **fields: Any) -> Recording:
        """Set the last fields as `update`, write the last line and wait, where `sync` holds, until all is on disk."""
        self.recording = updated(self.recording, {**fields, "log": self.log})
        self._line({**encode(fields), "end": self.recording.digest})
        self.close()
        if sync:
            sync_tree(self.folder)
        return self.recording

    def end_as(self, digest: str) -> None:
        """Write the last line of a recording whose digest is known."""
        self._line({"end": digest})
        self.close()

    def close(self) -> None:
        """Close the files; what was written stays."""
        self._journal.close()
        if self._log_file is not None:
            self._log_file.close()

    def _line(self, plain: dict[str, Any]) -> None:
        _write_all(self._journal, (to_json(plain) + "\n").encode())

    def _array(self, array: NDArray[Any] | None) -> dict[str, Any] | None:
        if array is None:
            return None
        name, array = self._new_name(".npy"), canonical_array(array)
        # numpy.save takes three times as many calls of the system
        with self._opened(name) as file:
            _write_all(file, _npy_header(array.dtype, array.shape))
            _write_all(file, array.reshape(-1).view(np.uint8).data if array.size else b"")
        return {"path": name, "crc32": crc32(array.data if array.size else b"")}

    def _opened(self, name: str) -> FileIO:
        # joining paths takes longer than opening a file
        return FileIO(f"{self.folder}/{name}", "x")

    def _new_name(self, ending: str) -> str:
        self._written += 1
        return f"{self._written:04d}{ending}"


def _copied(channel: Channel) -> Channel:
    time_s = None if channel.time_s is None else np.array(canonical_array(channel.time_s))
    return replace(channel, values=np.array(canonical_array(channel.values)), time_s=time_s)


def write_folder(recording: Recording, folder: Path, *, sync: bool = True) -> None:
    """Write a whole recording into an empty folder."""
    writer = FolderWriter(folder, replace(recording, series=(), files=(), log=""))
    for series in recording.series:
        writer.add_series(series)
    for item in recording.files:
        writer.add_file(item)
    if recording.log:
        writer.write_log(recording.log)
    writer.end(sync=sync)


@lru_cache(maxsize=256)
def _npy_header(dtype: np.dtype[Any], shape: tuple[int, ...]) -> bytes:
    """What stands before the numbers in a .npy file."""
    made = BytesIO()
    described = {"descr": np.lib.format.dtype_to_descr(dtype), "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(made, described)
    return made.getvalue()


def _write_all(file: FileIO, content: bytes | memoryview) -> None:
    # a disk that becomes full takes a part, and refuses the rest when it is asked again
    while content:
        content = content[file.write(content) :]


def checksum(path: Path) -> int:
    """CRC-32 of a file."""
    found = 0
    with path.open("rb") as opened:
        while piece := opened.read(1 << 20):
            found = crc32(piece, found)
    return found


def _plain_name(name: str) -> str:
    """The end of a name, in characters that every file system takes."""
    return re.sub(r"[^A-Za-z0-9._-]", "_", PurePosixPath(name).name)[-60:]
