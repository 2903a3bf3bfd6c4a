"""The order in which recordings come into a database, told as far as it is settled.

Where several write at once, as in PostgreSQL, row numbers are drawn before the rows are committed: a slower transaction
has lower numbers, and rows that come in front of others which somebody has read already. So each writer holds a lock
that tells above which number its rows are, and who reads in the order of numbers stops at the lowest of these.
"""

from __future__ import annotations

from sqlalchemy import Connection, text

__all__ = ["DRAW", "settled"]

MARK = 0x7061 << 48
"""In front of a row number, in the number of a lock."""
DRAW = f"""
WITH above AS MATERIALIZED (
    SELECT pg_advisory_xact_lock_shared({MARK} + last_value - CASE WHEN is_called THEN 0 ELSE 1 END)
    FROM recordings_id_seq
)
SELECT nextval('recordings_id_seq') FROM above, generate_series(1, %s)
"""
"""Locks first, and draws then: whoever finds no lock knows that what is drawn later is higher than what is there."""
LOWEST = text(f"""
SELECT min((classid::bigint << 32 | objid::bigint) - {MARK})
FROM pg_locks
WHERE locktype = 'advisory' AND objsubid = 1 AND classid::bigint >> 16 = {MARK >> 48}
    AND database = (SELECT oid FROM pg_database WHERE datname = current_database())
""")


def settled(connection: Connection) -> int | None:
    """The row number up to which no more recordings come; None where none comes in front of one that is there.

    It holds for what the same connection reads next, outside of a snapshot.
    """
    if connection.dialect.name != "postgresql":
        # one writer at a time
        return None
    found: int | None = connection.scalar(LOWEST)
    return found
