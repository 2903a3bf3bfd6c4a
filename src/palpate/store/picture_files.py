"""Whether a file is a picture, by what is in it."""

from __future__ import annotations

import re
from collections.abc import Mapping
from importlib.util import find_spec
from pathlib import Path

from palpate.store.errors import StoreError

__all__ = ["picture_type"]

BEGINNINGS: Mapping[str, bytes] = {
    "image/png": rb"\x89PNG\r\n\x1a\n",
    "image/jpeg": rb"\xff\xd8\xff",
    "image/gif": rb"GIF8[79]a",
    "image/tiff": rb"II\*\x00|MM\x00\*",
    "image/webp": rb"RIFF....WEBP",
}


def picture_type(path: Path, where: str) -> str:
    """The media type of a picture: of PNG, JPEG, GIF, TIFF or WebP, by its first bytes.

    Where Pillow is installed the rest is looked at too.

    Parameters
    ----------
    path
        The file.
    where
        Begins the message of the error.

    Raises
    ------
    StoreError
        If it is none, or a damaged one.
    """
    with path.open("rb") as file:
        head = file.read(16)
    for kind, beginning in BEGINNINGS.items():
        if re.match(beginning, head, re.DOTALL):
            if find_spec("PIL") is not None:
                _check_whole(path, where)
            return kind
    raise StoreError(f"{where}: {str(path)!r} is no picture, expected PNG, JPEG, GIF, TIFF or WebP")


def _check_whole(path: Path, where: str) -> None:
    from PIL import Image

    try:
        # `verify` finds wrong check sums and leaves a cut end to `load`
        with Image.open(path) as picture:
            picture.verify()
        with Image.open(path) as picture:
            picture.load()
    except Exception as error:
        # each format of Pillow has errors of its own
        raise StoreError(f"{where}: {str(path)!r} is a damaged picture ({error}), expected one that is whole") from None
