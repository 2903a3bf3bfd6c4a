"""Ids as they stand in a narrow table: as short as they can be told apart there."""

from __future__ import annotations

from collections.abc import Callable, Iterable

__all__ = ["shortened"]

LEAST = 8


def shortened(ids: Iterable[object], *, whole: bool = False) -> Callable[[object], str]:
    """What writes each of these ids: its first characters, eight or as many as none of the others begins with.

    Parameters
    ----------
    ids
        All that are shown together.
    whole
        Whether they are written whole.

    Examples
    --------
    >>> write = shortened(["0123456789a", "0123456780b"])
    >>> write("0123456789a"), write("0123456780b")
    ('0123456789', '0123456780')
    >>> shortened(["0123456789a"])("0123456789a")
    '01234567'
    """
    texts = {str(one) for one in ids}
    longest = max(map(len, texts), default=LEAST)
    length = LEAST
    while not whole and length < longest and len({text[:length] for text in texts}) < len(texts):
        length += 1
    return lambda one: str(one) if whole else str(one)[:length]
