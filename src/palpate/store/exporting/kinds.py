"""Kinds of columns: how each is stored in Parquet, and what Croissant and the Hugging Face Hub call it."""

from __future__ import annotations

from dataclasses import dataclass

import pyarrow as pa

__all__ = [
    "AUDIO",
    "BYTES",
    "IMAGE",
    "MOMENT",
    "NUMBER",
    "NUMBERS",
    "TEXT",
    "TEXTS",
    "TRUTH",
    "WHOLE",
    "WHOLES",
    "Kind",
    "vector",
]

EMBEDDED = pa.struct([("bytes", pa.binary()), ("path", pa.string())])


@dataclass(frozen=True)
class Kind:
    """A kind of column.

    Attributes
    ----------
    words
        What it is, for people.
    arrow
        Its type in Parquet.
    croissant
        The type of one of its values in Croissant.
    many
        Whether there are several values in each row.
    hub
        The feature of Hugging Face ``datasets``, where it does not follow from the type in Parquet.
    inside
        The part of a value that Croissant reads, where there are several.
    """

    words: str
    arrow: pa.DataType
    croissant: str
    many: bool = False
    hub: str | None = None
    inside: str | None = None


TEXT = Kind("text", pa.string(), "sc:Text")
NUMBER = Kind("number", pa.float64(), "sc:Float")
WHOLE = Kind("whole number", pa.int64(), "sc:Integer")
TRUTH = Kind("true or false", pa.bool_(), "sc:Boolean")
MOMENT = Kind("time (UTC)", pa.timestamp("us", tz="UTC"), "sc:Date")
TEXTS = Kind("list of texts", pa.list_(pa.string()), "sc:Text", many=True)
NUMBERS = Kind("list of numbers", pa.list_(pa.float64()), "sc:Float", many=True)
WHOLES = Kind("list of whole numbers", pa.list_(pa.int64()), "sc:Integer", many=True)
BYTES = Kind("bytes", pa.binary(), "sc:Text")
IMAGE = Kind("image", EMBEDDED, "sc:ImageObject", hub="Image", inside="bytes")
AUDIO = Kind("sound", EMBEDDED, "sc:AudioObject", hub="Audio", inside="bytes")


def vector(length: int) -> Kind:
    """So many numbers of 32 bits in each row; a single one is stored as such.

    Examples
    --------
    >>> vector(3).words
    '3 numbers'
    """
    if length == 1:
        return Kind("number", pa.float32(), "sc:Float")
    return Kind(f"{length} numbers", pa.list_(pa.float32(), length), "sc:Float", many=True)
