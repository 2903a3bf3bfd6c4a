"""A recording as a package, made part by part: however many series and files it has, one of them is in memory."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from hashlib import sha256
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import IO

from sqlalchemy import select

from palpate.store import schema
from palpate.store.content import channel_arrays
from palpate.store.errors import DamagedError
from palpate.store.importing.folder import FolderWriter
from palpate.store.importing.package import pack_folder
from palpate.store.legible import reading
from palpate.store.parts import Head, log_of, series_of
from palpate.store.records import FileItem, Recording
from palpate.store.store import Store
from palpate.store.stored_bytes import StoredBytes

__all__ = ["write_package"]

SAME = ("action", "owner", "licence", "ground_truth", "software", "repository", "grasp")


def write_package(store: Store, head: Head, file: IO[bytes]) -> None:
    """Write a package of all of a recording, and of its object that which is seen.

    Raises
    ------
    DamagedError
        If what is stored is not what was put.
    """
    with TemporaryDirectory() as name:
        with closing(FolderWriter(Path(name), _without_parts(head))) as writer:
            found = sha256(_document(store, head))
            for position in range(len(head.series)):
                _write_series(store, head, position, writer, found.update)
            _write_files(store, head, writer)
            log = log_of(store, head)
            if log:
                writer.write_log(log)
            found.update(log.encode())
            if found.hexdigest() != head.digest:
                raise DamagedError(f"recording {head.id}: digest {found.hexdigest()}, expected {head.digest}")
            writer.end_as(head.digest)
        pack_folder(Path(name), file)


def _write_series(
    store: Store, head: Head, position: int, writer: FolderWriter, hashed: Callable[[memoryview | bytes], None]
) -> None:
    """Write a series, of which nothing is left in memory when this ends."""
    series = series_of(store, head, position)
    if series is None:
        raise DamagedError(f"recording {head.id}: series {position} is missing")
    writer.write_series(series)
    for channel in series.channels:
        for array in channel_arrays(channel):
            hashed(array.data if array.size else b"")


def _write_files(store: Store, head: Head, writer: FolderWriter) -> None:
    with TemporaryDirectory() as name:
        path = Path(name) / "file"
        for item in head.files:
            content = StoredBytes(store.blobs, item.sha256)
            with path.open("wb") as file:
                for piece in content.pieces(0, content.size):
                    file.write(piece)
            writer.add_file(FileItem(item.name, item.media_type, path))


def _without_parts(head: Head) -> Recording:
    plain = head.document
    return Recording(
        id=head.id,
        recorded_at=head.recorded_at,
        thing=head.thing,
        setup=head.setup,
        visibility=head.visibility,
        embargoed_until=head.embargoed_until,
        gripper_pose=head.pose("gripper_pose"),
        object_pose=head.pose("object_pose"),
        entries=head.entries,
        notices=tuple(plain["notices"]),
        **{name: plain[name] for name in SAME},
    )


def _document(store: Store, head: Head) -> bytes:
    columns = schema.recordings.c
    with reading(store.engine) as connection:
        text: str = connection.execute(select(columns.document).where(columns.id == head.row)).scalar_one()
    return text.encode()
