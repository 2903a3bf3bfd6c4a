"""Errors: each is one sentence that says where, what was found and what would be right."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = [
    "EvidenceError",
    "ImpossibleEvidenceError",
    "LogError",
    "NetworkError",
    "PalpateError",
    "choices",
    "extra",
    "near",
    "plural",
]


class PalpateError(Exception):
    """Bad input of any kind; the command line prints it and exits with code 2."""


class NetworkError(PalpateError):
    """A network that cannot be used: the message names the file and the key."""


class EvidenceError(PalpateError, ValueError):
    """An outcome, action or property that the network does not know or cannot read."""


class ImpossibleEvidenceError(EvidenceError):
    """Evidence to which the network gives probability zero; the message names the observation."""


class LogError(PalpateError):
    """An episode log that cannot be read."""


def choices(names: Iterable[str]) -> str:
    """Return the valid choices as they stand in an error message.

    Examples
    --------
    >>> choices(["mug", "box"])
    "choose from 'mug', 'box'"
    """
    return "choose from " + ", ".join(repr(name) for name in names)


def extra(name: str) -> str:
    """Return how an extra is installed, as the end of an error message.

    Examples
    --------
    >>> extra("video")
    'pip install "palpate[video]" (in a clone: .venv/bin/pip install -e ".[video]")'
    """
    return f'pip install "palpate[{name}]" (in a clone: .venv/bin/pip install -e ".[{name}]")'


def near(found: object, names: Iterable[str]) -> str:
    """Return the valid name that was probably meant, to stand behind the wrong one; empty where none is near.

    Examples
    --------
    >>> near("muug", ["mug", "box"])
    " (did you mean 'mug'?)"
    >>> near("lamp", ["mug", "box"])
    ''
    """
    from difflib import get_close_matches  # only errors need it

    if not isinstance(found, str):
        return ""
    wrong = found.casefold()
    # Slips are seldom in the first letter: kettle is no misspelt bottle.
    valid = {name.casefold(): name for name in names if name.casefold()[:1] == wrong[:1]}
    close = get_close_matches(wrong, valid, 1)
    return f" (did you mean {valid[close[0]]!r}?)" if close else ""


def plural(count: int, noun: str) -> str:
    """Return a count and its noun.

    Examples
    --------
    >>> plural(1, "step"), plural(3, "step")
    ('1 step', '3 steps')
    """
    return f"{count} {noun}" if count == 1 else f"{count} {noun}s"
