"""Bags of any kind: a folder of ROS 2, a single file of one, an MCAP file, a bag of ROS 1."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory

from palpate.errors import extra
from palpate.store.errors import StoreError
from palpate.store.importing.bags import ros1_file
from palpate.store.importing.bags.mcap_file import MAGIC, McapFile
from palpate.store.importing.bags.metadata import METADATA, ROOT, Metadata, read_metadata
from palpate.store.importing.bags.packets import Source
from palpate.store.importing.bags.ros1_file import Ros1File
from palpate.store.importing.bags.sqlite_file import SqliteFile
from palpate.store.importing.bags.unpacking import unzstd_file

__all__ = ["Bag", "is_bag", "opened_bag"]

ENDINGS = (".mcap", ".db3", ".bag")
NEEDED = ("mcap", "rosbags")


@dataclass(frozen=True)
class Bag:
    """A bag that is open.

    Attributes
    ----------
    sources
        Its files.
    distribution
        The release of ROS 2 that wrote it, where the bag says so.
    counts
        Topic to the number of its messages, where the bag says so.
    """

    sources: tuple[Source, ...]
    distribution: str | None = None
    counts: Mapping[str, int] = field(default_factory=dict)


def is_bag(path: str | Path) -> bool:
    """Tell whether a file or folder is a bag; its content need not be right.

    Examples
    --------
    >>> is_bag("nowhere.mcap")
    False
    """
    path = Path(path)
    if path.is_dir():
        metadata = path / METADATA
        if not metadata.is_file():
            return False
        with metadata.open("rb") as file:
            return ROOT.encode() in file.read(1 << 16)
    if not path.is_file():
        return False
    with path.open("rb") as file:
        beginning = file.read(16)
    return path.suffix.lower() in ENDINGS or beginning.startswith((MAGIC, ros1_file.MAGIC))


@contextmanager
def opened_bag(path: Path) -> Iterator[Bag]:
    """Open a bag.

    Raises
    ------
    StoreError
        If it is none, or what reads bags is not installed.
    """
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise StoreError(f"bags need {missing[0]}, which is not installed: {extra('bags')}")
    if not path.is_dir():
        yield Bag((_source(path),))
    elif not (path / METADATA).is_file():
        raise StoreError(f"there is no {METADATA} in it, expected a bag; one without is imported file by file")
    else:
        with TemporaryDirectory() as folder:
            metadata = read_metadata(path)
            sources = tuple(_source_in(metadata, file, Path(folder)) for file in metadata.files)
            yield Bag(sources, metadata.distribution, metadata.counts)


def _source(path: Path) -> Source:
    try:
        with path.open("rb") as file:
            beginning = file.read(16)
    except OSError as error:
        raise StoreError(f"cannot be read: {error.strerror or error}") from error
    if beginning.startswith(MAGIC) or path.suffix.lower() == ".mcap":
        return McapFile(path)
    if beginning.startswith(ros1_file.MAGIC):
        return Ros1File(path)
    if path.suffix.lower() == ".db3":
        return SqliteFile(path)
    raise StoreError("is no bag, expected a folder of ROS 2, a file .mcap or .db3, or a .bag of ROS 1")


def _source_in(metadata: Metadata, path: Path, folder: Path) -> Source:
    if metadata.compression == "file":
        unpacked = folder / path.stem
        unzstd_file(path, unpacked)
        path = unpacked
    kind = McapFile if metadata.storage == "mcap" else SqliteFile
    return kind(path, is_packed=metadata.compression == "message")
