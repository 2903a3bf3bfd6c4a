"""Who else has sent a recording that was there: they see it as its first sender does, and do not learn of that one."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import Engine, and_, func, not_, or_, select, text

from palpate.store import schema
from palpate.store.database import changing
from palpate.store.embargo import is_over
from palpate.store.filters import digest_bytes
from palpate.store.registry import now_us

__all__ = ["note_sender"]

CHUNK = 400
NOTE = text("INSERT INTO senders (name, recording_id, sent_us) VALUES (:name, :row, :now) ON CONFLICT DO NOTHING")


def note_sender(engine: Engine, digests: Sequence[str], name: str) -> set[str]:
    """Note that an account has sent recordings that are there.

    Returns
    -------
    set of str
        Digests of those that were hidden from it until now: to the account they are new.
    """
    hidden = set[str]()
    for start in range(0, len(digests), CHUNK):
        hidden |= _noted(engine, digests[start : start + CHUNK], name)
    return hidden


def _noted(engine: Engine, digests: Sequence[str], name: str) -> set[str]:
    columns, now = schema.recordings.c, now_us()
    is_open = and_(columns.visibility.in_(("public", "lab")), is_over(schema.recordings, now))
    theirs = or_(func.coalesce(columns.owner, "") == name, func.coalesce(columns.uploaded_by, "") == name)
    asked = select(columns.id, columns.digest, is_open.label("is_open")).where(
        columns.digest.in_([digest_bytes(digest) for digest in digests]), not_(theirs)
    )
    with engine.connect() as connection:
        others = connection.execute(asked).all()
    if not others:
        return set()
    with changing(engine) as connection:
        noted = [one for one in others if connection.execute(NOTE, {"name": name, "row": one.id, "now": now}).rowcount]
    return {one.digest.hex() for one in noted if not one.is_open}
