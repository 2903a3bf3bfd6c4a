"""A database that goes away: told in one sentence, and waited for where a transaction may be done again."""

from __future__ import annotations

import random
import sqlite3
import time
from collections.abc import Callable
from typing import TypeVar

from sqlalchemy import Engine, event
from sqlalchemy.engine import ExceptionContext
from sqlalchemy.exc import DataError

from palpate.store.errors import DamagedError, IncompleteError, StoreError, UnavailableError

__all__ = ["LostError", "is_gone", "not_asked", "not_kept", "outage", "patiently", "tell_outages"]

PATIENCE_S = 30.0
"""How long a server may be away, as while it is restarted."""
FIRST_PAUSE_S, LONGEST_PAUSE_S = 0.1, 2.0
DAMAGED = ("SQLITE_CORRUPT", "SQLITE_NOTADB")
UNDECODED = "Could not decode to UTF-8"
"""What Python's driver says of text that is none, and has no code for."""
MISSING = ("no such table", "no such column")
MISSING_STATES = ("42P01", "42703")
"""PostgreSQL's codes for tables and columns."""
GONE = ("57P", "08")
"""Its classes of errors for a server that is told to stop, and for a connection that broke."""
NOT_TAKEN = ("22", "54")
"""PostgreSQL's classes of errors for what is sent: no data of its type, and more than its limits allow."""
NOT_ASKED = (None, "22003", "22021", "22P05")
"""Its codes for a number out of range and for letters that it does not have; none where the driver says so."""
Done = TypeVar("Done")


class LostError(UnavailableError):
    """A server that cannot be reached, or no longer; what was being committed may or may not be there."""


def tell_outages(engine: Engine) -> None:
    """Let every use of an engine say in one sentence that the server went away, or that something is damaged."""

    @event.listens_for(engine, "handle_error")
    def tell(context: ExceptionContext) -> Exception | None:
        # a connection that waited in the pool is replaced without a word
        if context.is_pre_ping:
            return None
        context.is_disconnect = context.is_disconnect or is_gone(context.original_exception)
        lost = context.is_disconnect or context.connection is None
        return outage(engine, context.original_exception, lost=lost)


def is_gone(error: BaseException | None) -> bool:
    """Whether PostgreSQL said that it goes away, also where its driver stumbled over that and said something else."""
    while error is not None:
        if (getattr(error, "sqlstate", None) or "").startswith(GONE):
            return True
        error = error.__cause__ or error.__context__
    return False


def outage(engine: Engine, error: BaseException, *, lost: bool) -> StoreError | None:
    """What an error of the driver is: something is damaged, cannot be asked for, or the server is `lost`; or None."""
    place, said = f"store {engine.url!r}", " ".join(str(error).split())
    if said.startswith(MISSING) or getattr(error, "sqlstate", None) in MISSING_STATES:
        return IncompleteError(f"{place}: {said}; expected all tables that palpate made")
    if getattr(error, "sqlite_errorname", "").startswith(DAMAGED) or said.startswith(UNDECODED):
        return DamagedError(f"{place}: {said}; expected the SQLite file that was written")
    if isinstance(error, UnicodeEncodeError | OverflowError):
        # the driver has not asked yet, and the database is there
        return not_asked()
    if lost and engine.dialect.name == "postgresql":
        return LostError(f"{place}: {said}; expected a server that answers")
    return None


def not_asked(error: DataError | None = None) -> StoreError | None:
    """What is wrong with a question where the database, or its driver, does not take what is looked for."""
    if error is not None and getattr(error.orig, "sqlstate", None) not in NOT_ASKED:
        return None
    return StoreError(
        "a number or a text is none that a database can look for, expected numbers of 64 bits and letters"
    )


def not_kept(engine: Engine, error: BaseException) -> StoreError:
    """What an error of the driver is where something was to be kept: of the database, or of what was sent to it.

    Examples
    --------
    >>> import sqlite3
    >>> from palpate.store.database import connect
    >>> not_kept(connect("sqlite://"), sqlite3.DataError("string or blob too big"))
    StoreError('holds what the database does not take: string or blob too big; nothing was kept')
    """
    # PostgreSQL's messages have several lines
    said = " ".join(str(error).split())
    state = getattr(error, "sqlstate", None) or ""
    if state.startswith(NOT_TAKEN) or isinstance(error, sqlite3.DataError):
        return StoreError(f"holds what the database does not take: {said}; nothing was kept")
    return UnavailableError(f"store {engine.url!r}: {said}; nothing was kept")


def patiently(work: Callable[[], Done]) -> Done:
    """Do a transaction again that lost its server, for as long as a server takes to start.

    Parameters
    ----------
    work
        A transaction that changes nothing when it is done a second time, as nobody knows whether it was committed.

    Raises
    ------
    LostError
        If the server stays away.
    """
    end, pause_s = time.monotonic() + PATIENCE_S, FIRST_PAUSE_S
    while True:
        try:
            return work()
        except LostError:
            if time.monotonic() + pause_s > end:
                raise
        # by chance, so that all who lost one server do not come back at once
        time.sleep(pause_s * random.uniform(0.5, 1.0))
        pause_s = min(2 * pause_s, LONGEST_PAUSE_S)
