"""What people are told about surprise numbers."""

from __future__ import annotations

__all__ = ["SURPRISING", "impossible"]

SURPRISING = 0.01
IMPOSSIBLE = 1e-6


def impossible(surprise: float | None) -> str | None:
    """What to suspect where a surprise number is practically zero; None where it is not.

    Examples
    --------
    >>> impossible(1e-9)
    'practically impossible under this network: wrong sensor, wrong unit, or an object it does not know'
    >>> impossible(0.3), impossible(None)
    (None, None)
    """
    if surprise is None or surprise >= IMPOSSIBLE:
        return None
    return "practically impossible under this network: wrong sensor, wrong unit, or an object it does not know"
