"""Files the command line writes: refused before the work begins, and never half-written."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from palpate.errors import PalpateError, choices

__all__ = ["check_ending", "check_picture", "check_writable", "replacing"]

PICTURES = (".png", ".svg", ".pdf")


def check_writable(option: str, path: Path) -> None:
    """Refuse a path that no file can be written to, before anything is done."""
    folder = path.parent
    if path.is_dir():
        raise PalpateError(f"{option}: {path} is a folder, expected the path of a file")
    if not folder.is_dir():
        raise PalpateError(f"{option}: the folder {folder} does not exist, expected one that does")
    target = path if path.exists() else folder
    if not os.access(target, os.W_OK):
        raise PalpateError(f"{option}: {target} cannot be written, expected a place with permission to write")


def check_picture(option: str, path: Path) -> None:
    """Refuse a picture of a kind that cannot be drawn, or where it cannot be written."""
    if path.suffix.lower() not in PICTURES:
        raise PalpateError(f"{option}: {path} has no ending of a picture; {choices(PICTURES)}")
    check_writable(option, path)


def check_ending(option: str, path: Path, ending: str) -> None:
    """Refuse a file of another kind, or where it cannot be written."""
    if path.suffix.lower() != ending:
        raise PalpateError(f"{option}: {path} was found, expected a name that ends in {ending}")
    check_writable(option, path)


@contextmanager
def replacing(path: Path) -> Iterator[Path]:
    """A path to write to that takes the place of `path` once all went well, and vanishes otherwise."""
    handle, name = tempfile.mkstemp(prefix=f".{path.stem}-", suffix=path.suffix, dir=path.parent)
    os.close(handle)
    draft = Path(name)
    try:
        yield draft
        # mkstemp lets only the owner read; a file made in the usual way lets more
        mask = os.umask(0)
        os.umask(mask)
        draft.chmod(0o666 & ~mask)
        draft.replace(path)
    finally:
        draft.unlink(missing_ok=True)
