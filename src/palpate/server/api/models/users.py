"""The forms of accounts and tokens."""

from __future__ import annotations

from datetime import datetime

from palpate.server.api.models.basics import Strict

__all__ = ["Token", "User"]


class User(Strict):
    """An account."""

    name: str
    role: str
    email: str | None
    created_at: datetime
    tokens: int


class Token(Strict):
    """A token without its secret."""

    id: int
    user: str
    role: str
    created_at: datetime
    expires_at: datetime | None
    revoked_at: datetime | None
