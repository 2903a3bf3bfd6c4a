"""What somebody searches for, word by word."""

from __future__ import annotations

__all__ = ["search_words"]

MOST_WORDS = 8
"""Each is a condition in the question to the database; what comes after them is looked for as it stands."""


def search_words(text: str) -> list[str]:
    """The words of a search, each of which must be found, in any order.

    Examples
    --------
    >>> search_words(" ceramic  mug"), len(search_words("a b c d e f g h i j"))
    (['ceramic', 'mug'], 8)
    """
    return text.split(maxsplit=MOST_WORDS - 1)
