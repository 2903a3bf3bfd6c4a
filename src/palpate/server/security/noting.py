"""The audit of accounts: who changed what about whom; secrets are never part of it."""

from __future__ import annotations

from sqlalchemy import insert

from palpate.store import schema
from palpate.store.content import to_json
from palpate.store.database import changing
from palpate.store.registry import now_us
from palpate.store.store import Store

__all__ = ["ACCOUNT", "note_account"]

ACCOUNT = "account"


def note_account(store: Store, who: str | None, account: str | None, did: str) -> None:
    """Add a line to the audit.

    Parameters
    ----------
    who
        Who did it.
    account
        Whose account it was done to; None where a token was ended by its number alone.
    did
        What was done, in words.
    """
    row = {"at_us": now_us(), "who": who, "what": ACCOUNT, "detail": to_json({"account": account, "did": did})}
    with changing(store.engine) as connection:
        connection.execute(insert(schema.audit).values(**row))
