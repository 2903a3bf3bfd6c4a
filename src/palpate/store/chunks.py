"""So many at a time that a database can be asked for them in one statement."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TypeVar

__all__ = ["CHUNK", "chunks"]

CHUNK = 400
One = TypeVar("One")


def chunks(items: Sequence[One], most: int = CHUNK) -> Iterator[Sequence[One]]:
    """The items in order, `most` of them each time.

    Examples
    --------
    >>> list(chunks("abcde", 2))
    ['ab', 'cd', 'e']
    """
    return (items[start : start + most] for start in range(0, len(items), most))
