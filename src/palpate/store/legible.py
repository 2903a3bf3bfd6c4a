"""Reading what may be damaged: one sentence in place of whatever a parser or the database says."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

from sqlalchemy import Connection, Engine
from sqlalchemy.exc import DataError, DBAPIError

from palpate.store.database import asking
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.outages import not_asked

__all__ = ["legible", "reading"]

UNREADABLE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)
MOST = 120
"""Letters of what a parser says, which may repeat all that it was given."""


@contextmanager
def legible(where: object) -> Iterator[None]:
    """Say where something is that cannot be read in the block; ``str(where)`` is asked for only then.

    Raises
    ------
    DamagedError
        If it cannot.

    Examples
    --------
    >>> with legible("setup 3"):
    ...     int("mug")
    Traceback (most recent call last):
    palpate.store.errors.DamagedError: setup 3: cannot be read (ValueError: invalid literal for int() with base 10: \
'mug'), expected what was written
    """
    try:
        yield
    except StoreError:
        raise
    except UNREADABLE as error:
        said = " ".join(str(error).split())
        told = f"{type(error).__name__}: {said[:MOST]}{'...' if said[MOST:] else ''}"
        raise DamagedError(f"{where}: cannot be read ({told}), expected what was written") from error


@contextmanager
def reading(engine: Engine) -> Iterator[Connection]:
    """A connection to read by; what goes wrong in the block is told in one sentence.

    Raises
    ------
    StoreError
        If something is looked for that no database can look for.
    DamagedError
        If what is stored cannot be read, or tables are missing.
    UnavailableError
        If the database does not answer, or refuses.
    """
    place = f"store {engine.url!r}"
    try:
        with legible(place), asking(engine) as connection:
            yield connection
    except DBAPIError as error:
        if isinstance(error, DataError) and (flaw := not_asked(error)) is not None:
            raise flaw from None
        raise UnavailableError(f"{place}: {' '.join(str(error.orig).split())}") from None
