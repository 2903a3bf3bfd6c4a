"""A video file that grows by a picture at a time."""

from __future__ import annotations

from collections.abc import Generator
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError, extra

__all__ = ["RATE_HZ", "Film", "check_film"]

RATE_HZ = 25
BLOCK = 16
"""Sides of a video are multiples of this number of pixels."""


def check_film() -> None:
    """Say what is missing where no video can be written."""
    if find_spec("imageio_ffmpeg") is None:
        raise PalpateError(f"a video needs imageio-ffmpeg, which is not installed: {extra('video')}")


class Film:
    """Writes pictures to an MP4 file (H.264), by the extra ``video``; to be closed.

    Parameters
    ----------
    path
        The file; it ends in .mp4.
    size
        Width and height [pixels], multiples of 16.

    Examples
    --------
    ::

        with Film(path, (640, 480)) as film:
            film.add(picture, seconds=2.0)
    """

    def __init__(self, path: Path, size: tuple[int, int]) -> None:
        check_film()
        import imageio_ffmpeg

        if any(side % BLOCK for side in size):
            raise PalpateError(f"a video of {size[0]} x {size[1]} was asked for, expected multiples of {BLOCK}")
        self.size = size
        self._writer: Generator[None, Any, None] = imageio_ffmpeg.write_frames(
            str(path), size, fps=RATE_HZ, codec="libx264", quality=7, ffmpeg_log_level="error"
        )
        self._writer.send(None)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def add(self, picture: NDArray[np.uint8], seconds: float = 0.0) -> None:
        """Show a picture, (height, width, 3), for so long; for one frame at least."""
        width, height = self.size
        if picture.shape != (height, width, 3) or picture.dtype != np.uint8:
            found = f"a picture of {picture.dtype} and shape {picture.shape} was found"
            raise PalpateError(f"{found}, expected uint8 and ({height}, {width}, 3)")
        frame = np.ascontiguousarray(picture)
        for _ in range(max(1, round(seconds * RATE_HZ))):
            self._writer.send(frame)

    def close(self) -> None:
        """End the file; may be called twice."""
        self._writer.close()
