"""The forms of accounts and tokens."""

from __future__ import annotations

from datetime import datetime
from typing import Literal

from pydantic import Field

from palpate.server.api.models.basics import Strict

__all__ = ["NewToken", "Token", "TokenAsked", "User"]


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
    is_session: bool


class TokenAsked(Strict):
    """A token to make: what it may do at most, all that who asks may unless told; after how many days it expires."""

    role: Literal["reader", "owner", "curator", "admin"] | None = None
    days: float = Field(365.0, gt=0.5, le=36_500)


class NewToken(Strict):
    """A token with its secret, which nobody can tell again."""

    token: str
