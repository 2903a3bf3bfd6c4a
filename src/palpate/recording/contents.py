"""Bytes of what a measurement wants to keep as a file: bytes, text, pictures, figures."""

from __future__ import annotations

import io
import json
from pathlib import Path, PurePosixPath
from typing import Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from palpate.recording.errors import RecordingError
from palpate.store.errors import StoreError
from palpate.store.pictures import png

__all__ = ["Content", "Figure", "content_of", "json_of"]


@runtime_checkable
class Figure(Protocol):
    """A figure of matplotlib."""

    def savefig(self, file: io.BytesIO, /, *, format: str) -> None:
        """Draw it into a file."""


Content = bytes | str | Path | Figure | NDArray[np.uint8] | NDArray[np.uint16]


def content_of(name: str, content: Content) -> bytes | Path:
    """Return bytes to keep, or the path of a file to copy.

    Raises
    ------
    RecordingError
        If nothing is known to make of it.
    """
    ending = PurePosixPath(name).suffix.lower()
    if isinstance(content, Path):
        if not content.is_file():
            raise RecordingError(f"file {name!r}: there is no file {str(content)!r}, expected one to copy")
        return content
    if isinstance(content, str):
        return content.encode()
    if isinstance(content, bytes):
        return content
    if isinstance(content, np.ndarray):
        if ending != ".png":
            raise RecordingError(f"file {name!r}: an array was given, expected a name that ends in .png for a picture")
        try:
            return png(content, f"file {name!r}")
        except StoreError as error:
            raise RecordingError(str(error)) from error
    if isinstance(content, Figure):
        drawn = io.BytesIO()
        content.savefig(drawn, format=ending.removeprefix(".") or "png")
        return drawn.getvalue()
    found = type(content).__name__
    raise RecordingError(f"file {name!r}: found {found}, expected bytes, text, a path, a picture or a figure")


def json_of(where: str, value: object) -> bytes:
    """Return a value as JSON; RecordingError where JSON cannot hold it."""
    plain = value.tolist() if isinstance(value, np.ndarray | np.generic) else value
    try:
        return json.dumps(plain, allow_nan=False, ensure_ascii=False).encode()
    except (TypeError, ValueError) as error:
        raise RecordingError(f"{where}: {error}, expected what JSON can hold") from error
