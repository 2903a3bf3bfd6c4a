"""Who else has sent a recording that was there: they see it as its first sender does, and do not learn of that one."""

from __future__ import annotations

from collections.abc import Sequence

from sqlalchemy import Engine, func, not_, or_, select, text

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.database import asking, changing
from palpate.store.filters import digest_bytes
from palpate.store.registry import now_us
from palpate.store.viewing import Viewer

__all__ = ["note_sender"]

NOTE = text("INSERT INTO senders (name, recording_id, sent_us) VALUES (:name, :row, :now) ON CONFLICT DO NOTHING")


def note_sender(engine: Engine, digests: Sequence[str], name: str) -> set[str]:
    """Note that an account has sent recordings that are there.

    Returns
    -------
    set of str
        Digests of those that were hidden from it until now: to the account they are new.
    """
    hidden = set[str]()
    for some in chunks(digests):
        hidden |= _noted(engine, some, name)
    return hidden


def _noted(engine: Engine, digests: Sequence[str], name: str) -> set[str]:
    columns, now = schema.recordings.c, now_us()
    is_open = Viewer(lab=True).of(schema.recordings)
    theirs = or_(func.coalesce(columns.owner, "") == name, func.coalesce(columns.uploaded_by, "") == name)
    asked = select(columns.id, columns.digest, is_open.label("is_open")).where(
        columns.digest.in_([digest_bytes(digest) for digest in digests]), not_(theirs)
    )
    with asking(engine) as connection:
        others = connection.execute(asked).all()
    if not others:
        return set()
    with changing(engine) as connection:
        noted = [one for one in others if connection.execute(NOTE, {"name": name, "row": one.id, "now": now}).rowcount]
    return {one.digest.hex() for one in noted if not one.is_open}
