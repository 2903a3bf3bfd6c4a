"""Waiting until files and their names are on the disk, so that a power cut finds them there."""

from __future__ import annotations

import os
from pathlib import Path

__all__ = ["make_folder", "sync_file", "sync_folder", "sync_tree"]


def make_folder(folder: Path) -> None:
    """Make a folder, and those it is in where they are missing; the names of new ones are on the disk then."""
    new = [one for one in (folder, *folder.parents) if not one.exists()]
    folder.mkdir(parents=True, exist_ok=True)
    for one in new:
        sync_folder(one.parent)


def sync_tree(folder: Path) -> None:
    """Wait until a folder, and all that is in it, is on the disk."""
    for path in folder.iterdir():
        sync_tree(path) if path.is_dir() else sync_file(path)
    sync_folder(folder)


def sync_file(path: Path) -> None:
    """Wait until a file's content is on the disk."""
    # Windows flushes only what is open for writing
    _sync(path, os.O_RDWR)


def sync_folder(path: Path) -> None:
    """Wait until a folder's names are on the disk; Windows has no such call and needs none."""
    if os.name != "nt":
        _sync(path, os.O_RDONLY)


def _sync(path: Path, how: int) -> None:
    handle = os.open(path, how)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
