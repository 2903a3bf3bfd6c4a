"""Images and point clouds of a topic as files, and where their content waits."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from palpate.store.importing.bags.clouds import cloud_file, is_cloud
from palpate.store.importing.bags.images import image_file
from palpate.store.importing.bags.topics import FilesFrom
from palpate.store.importing.paths import media_type_of
from palpate.store.records import FileItem

__all__ = ["Files", "Spill", "item"]

MEDIA_TYPES = {".pcd": "application/vnd.pointcloud-pcd", ".webp": "image/webp", ".npy": "application/x-npy"}
"""Where mimetypes knows none, or not on every computer."""


class Spill:
    """Where the content of files is until a store takes it: in a folder, or in memory where there is none."""

    def __init__(self, folder: Path | None) -> None:
        self._folder, self._count = folder, 0

    def keep(self, data: bytes) -> bytes | Path:
        """Put bytes there."""
        if self._folder is None:
            return data
        self._count += 1
        path = self._folder / f"{self._count:06d}"
        path.write_bytes(data)
        return path


class Files:
    """Every so many-th message of a topic as a file."""

    def __init__(self, wanted: FilesFrom, where: str, spill: Spill) -> None:
        self.wanted, self.where = wanted, where
        self._spill = spill
        self._kept: list[tuple[str, bytes | Path]] = []

    @property
    def count(self) -> int:
        """How many files there are."""
        return len(self._kept)

    def take(self, message: Any, place: int) -> None:
        """Add a message, the `place`-th of its topic, where it is one of those that are wanted."""
        if place % self.wanted.every:
            return
        ending, data = (
            (".pcd", cloud_file(message, self.where)) if is_cloud(message) else image_file(message, self.where)
        )
        self._kept.append((ending, self._spill.keep(data)))

    def items(self, order: Iterable[int]) -> Iterator[FileItem]:
        """The files in an order, by which they are numbered."""
        for number, place in enumerate(order):
            ending, data = self._kept[place]
            yield item(f"{self.wanted.folder}/{number:06d}{ending}", data)


def item(name: str, data: bytes | Path) -> FileItem:
    """A file with the media type that its name stands for."""
    return FileItem(name, MEDIA_TYPES.get(Path(name).suffix) or media_type_of(name), data)
