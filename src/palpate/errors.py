"""Errors: each is one sentence that says where, what was found and what would be right."""

from __future__ import annotations

from collections.abc import Iterable

__all__ = ["EvidenceError", "ImpossibleEvidenceError", "LogError", "NetworkError", "PalpateError", "choices"]


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
