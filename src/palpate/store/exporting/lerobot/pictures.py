"""Images as frames hold them: three channels of eight bits."""

from __future__ import annotations

from dataclasses import dataclass
from io import BytesIO

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from palpate.store.errors import StoreError

__all__ = ["Pixels", "pixels_of", "size_of"]

EIGHT_BITS = ("1", "L", "LA", "P", "PA", "RGB", "RGBA", "CMYK", "YCbCr")
UNREADABLE = (OSError, ValueError, SyntaxError, Image.DecompressionBombError)


@dataclass(frozen=True)
class Pixels:
    """An image: the bytes of a file, and what is in it, (height, width, 3)."""

    encoded: bytes
    values: NDArray[np.uint8]


def size_of(data: bytes) -> tuple[int, int] | None:
    """Height and width; None for what is no image, or one of more than eight bits, as depth is."""
    try:
        with Image.open(BytesIO(data)) as image:
            return (image.height, image.width) if image.mode in EIGHT_BITS else None
    except UNREADABLE:
        return None


def pixels_of(name: str, data: bytes) -> Pixels:
    """Read an image; one in other colours than red, green and blue is turned into PNG in these.

    Raises
    ------
    StoreError
        If it cannot be read.
    """
    try:
        with Image.open(BytesIO(data)) as image:
            if image.mode == "RGB":
                return Pixels(data, np.asarray(image))
            turned = image.convert("RGB")
    except UNREADABLE:
        raise StoreError(f"the image {name} cannot be read") from None
    encoded = BytesIO()
    turned.save(encoded, "PNG")
    return Pixels(encoded.getvalue(), np.asarray(turned))
