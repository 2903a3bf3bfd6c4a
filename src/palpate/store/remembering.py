"""Remembering what was worked out, where others choose of what: so many of it, and nothing large."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import ParamSpec, TypeVar

__all__ = ["LARGEST", "remembered"]

LARGEST = 16 << 10
"""Letters and bytes of what is asked, beyond which it is worked out each time."""
Asked = ParamSpec("Asked")
Answer = TypeVar("Answer")


def remembered(most: int) -> Callable[[Callable[Asked, Answer]], Callable[Asked, Answer]]:
    """As `functools.lru_cache`, for functions whose arguments somebody else chooses.

    Parameters
    ----------
    most
        Answers that are remembered.

    Examples
    --------
    >>> @remembered(2)
    ... def shout(word: str) -> str:
    ...     print("thinks")
    ...     return word.upper()
    >>> shout("a"), shout("a")
    thinks
    ('A', 'A')
    """

    def decorate(work_out: Callable[Asked, Answer]) -> Callable[Asked, Answer]:
        kept = lru_cache(maxsize=most)(work_out)

        @wraps(work_out)
        def asked(*args: Asked.args, **options: Asked.kwargs) -> Answer:
            is_small = _size(args) <= LARGEST
            # what is asked can be hashed, or lru_cache says so
            return kept(*args, **options) if is_small else work_out(*args, **options)  # type: ignore[arg-type]

        return asked

    return decorate


def _size(asked: object) -> int:
    if isinstance(asked, str | bytes):
        return len(asked)
    return sum(map(_size, asked)) if isinstance(asked, tuple) else 1
