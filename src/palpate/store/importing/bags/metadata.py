"""The folder of a ROS 2 bag: which files are in it, as its ``metadata.yaml`` says."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from palpate.errors import choices
from palpate.store.errors import StoreError
from palpate.store.importing.paths import inside

__all__ = ["METADATA", "Metadata", "read_metadata"]

METADATA = "metadata.yaml"
ROOT = "rosbag2_bagfile_information"
STORAGES = ("mcap", "sqlite3")
LARGEST_BYTES = 8 << 20


@dataclass(frozen=True)
class Metadata:
    """What the file says.

    Attributes
    ----------
    files
        The files with messages, in order.
    storage
        mcap or sqlite3.
    compression
        What is compressed by zstd: ``"file"``, ``"message"``, or nothing, which is ``""``.
    distribution
        The release of ROS 2 that wrote it; None where it does not say.
    counts
        Topic to the number of its messages.
    """

    files: tuple[Path, ...]
    storage: str
    compression: str
    distribution: str | None
    counts: Mapping[str, int]


def read_metadata(folder: Path) -> Metadata:
    """Read the metadata of a bag.

    Raises
    ------
    StoreError
        If they cannot be read, name a file that is outside the folder or not there, or speak of something that is
        not supported.
    """
    about = _load(folder / METADATA)
    # never the words of what is no text, as aliases of YAML can stand for more words than there is room
    storage, mode, packed_by, release = (
        value if isinstance(value := about.get(key), str) else ""
        for key in ("storage_identifier", "compression_mode", "compression_format", "ros_distro")
    )
    mode = "" if mode.lower() == "none" else mode.lower()
    if storage not in STORAGES:
        raise StoreError(f"{METADATA}: storage_identifier is {storage!r}; {choices(STORAGES)}")
    if mode and (mode not in ("file", "message") or packed_by != "zstd"):
        found = f"compression by {packed_by!r} of each {mode}"
        raise StoreError(f"{METADATA}: {found} is not supported, expected 'zstd' of each file or message")
    names = about.get("relative_file_paths")
    if not isinstance(names, list) or not names or not all(isinstance(name, str) for name in names):
        raise StoreError(f"{METADATA}: relative_file_paths is no list of names, expected the files of the bag")
    return Metadata(
        files=tuple(_file(folder, name) for name in dict.fromkeys(names)),
        storage=storage,
        compression=mode,
        distribution=release or None,
        counts=_counts(about),
    )


def _load(path: Path) -> Mapping[str, Any]:
    import yaml

    if path.stat().st_size > LARGEST_BYTES:
        raise StoreError(f"{METADATA}: {path.stat().st_size} bytes, expected {LARGEST_BYTES} at most")
    try:
        content = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        told = " ".join(str(error).split())
        raise StoreError(f"{METADATA}: is no readable YAML: {told}") from error
    about = content.get(ROOT) if isinstance(content, Mapping) else None
    if not isinstance(about, Mapping):
        raise StoreError(f"{METADATA}: found no table {ROOT!r}, expected the one of a ROS 2 bag")
    return about


def _file(folder: Path, name: str) -> Path:
    path = inside(folder, name, f"{METADATA}: relative_file_paths")
    if not path.is_file():
        # the first versions gave the path from beside the folder
        path = inside(folder, PurePosixPath(name).name, f"{METADATA}: relative_file_paths")
    if not path.is_file():
        raise StoreError(f"{METADATA}: there is no file {name!r}, expected all files of the bag in its folder")
    return path


def _counts(about: Mapping[str, Any]) -> dict[str, int]:
    """Messages of each topic, where they are told in a way that can be read; they only serve to notice losses."""
    counts: dict[str, int] = {}
    topics = about.get("topics_with_message_count")
    for one in topics if isinstance(topics, list) else []:
        topic = one.get("topic_metadata") if isinstance(one, Mapping) else None
        name = topic.get("name") if isinstance(topic, Mapping) else None
        count = one.get("message_count") if isinstance(one, Mapping) else None
        if isinstance(name, str) and isinstance(count, int):
            counts[name] = counts.get(name, 0) + count
    return counts
