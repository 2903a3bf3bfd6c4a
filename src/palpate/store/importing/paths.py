"""Names of files, also those that stand in files from others: nothing outside their own folder is ever opened."""

from __future__ import annotations

import mimetypes
import os
from functools import lru_cache
from pathlib import Path, PurePosixPath, PureWindowsPath

from palpate.store.errors import StoreError

__all__ = ["check_name", "inside", "leads_inside", "media_type_of", "portable_name"]


@lru_cache(maxsize=1024)
def check_name(name: str, where: str) -> str:
    """Return the relative path that a file's name stands for; it has forward slashes.

    Raises
    ------
    StoreError
        If the name is empty, absolute, has a drive, leads out of its folder by ``..``, or holds a character that
        some file system does not allow.

    Examples
    --------
    >>> check_name("imgs/cam0.png", "file")
    'imgs/cam0.png'
    >>> check_name("../../etc/passwd", "file")
    Traceback (most recent call last):
    palpate.store.errors.StoreError: file: '../../etc/passwd' leads out of its folder, expected a path inside it
    """
    windows = PureWindowsPath(name)
    if windows.drive or windows.root or PurePosixPath(name).is_absolute():
        raise StoreError(f"{where}: {name!r} is an absolute path, expected one inside its folder")
    if ".." in windows.parts:
        raise StoreError(f"{where}: {name!r} leads out of its folder, expected a path inside it")
    if not windows.parts or any(ord(letter) < 32 or letter in '<>:"|?*' for letter in name):
        raise StoreError(
            f"{where}: {name!r} is no name that a file can have everywhere, expected one such as 'a/b.png'"
        )
    return windows.as_posix()


def portable_name(name: str) -> str:
    """Return the name for a file that is there, with ``_`` for characters that some file system does not allow.

    Examples
    --------
    >>> portable_name("imgs/12:30:05.png")
    'imgs/12_30_05.png'
    """
    return "".join("_" if _is_odd(letter) else letter for letter in name)


def _is_odd(letter: str) -> bool:
    # bytes that are no text stand as halves of surrogate pairs
    return ord(letter) < 32 or letter in '<>:"|?*\\' or "\ud800" <= letter <= "\udfff"


def inside(folder: Path, name: str, where: str) -> Path:
    """Return the path of a file that a name in `folder` stands for, whether it is there or not.

    Raises
    ------
    StoreError
        As `check_name`, or if a symbolic link on the way leads out of the folder.
    """
    path = folder / check_name(name, where)
    if not leads_inside(folder, path):
        raise StoreError(f"{where}: {name!r} is a link that leads out of its folder, expected a path inside it")
    return path


def leads_inside(folder: Path, path: Path) -> bool:
    """Tell whether a path is inside a folder after all links on the way were followed."""
    # a link to itself leads nowhere, and pathlib has an error for it
    return Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder))


def media_type_of(name: str) -> str:
    """Return the media type that a name's ending stands for.

    Examples
    --------
    >>> media_type_of("imgs/cam0.png"), media_type_of("cloud.unheard-of")
    ('image/png', 'application/octet-stream')
    """
    return mimetypes.guess_type(name)[0] or "application/octet-stream"
