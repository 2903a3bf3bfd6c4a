"""Passwords: kept as what a slow function makes of them, so that whoever reads the database has not read them."""

from __future__ import annotations

import base64
import secrets
import threading
from hashlib import scrypt
from hmac import compare_digest

from palpate.errors import plural
from palpate.store.errors import StoreError

__all__ = ["hashed", "is_password"]

LOG_COST, BLOCK, PARALLEL = 15, 8, 1
"""2^15 rounds of 1 KiB x 8: 32 MiB and about a tenth of a second."""
MEMORY = 1 << 26
at_once = threading.BoundedSemaphore(2)
SHORTEST, LONGEST = 10, 200
NOBODYS = "scrypt$15$8$1$AAAAAAAAAAAAAAAAAAAAAA==$" + base64.b64encode(bytes(32)).decode()
"""What a password is compared to where there is no account: that must take as long."""


def hashed(password: str) -> str:
    """What is kept of a password: the name and cost of the function, a random salt, and what comes out.

    Raises
    ------
    StoreError
        If it is too short to be one, or too long.

    Examples
    --------
    >>> is_password("correct horse", hashed("correct horse")), is_password("wrong horse", hashed("correct horse"))
    (True, False)
    """
    if not SHORTEST <= len(password) <= LONGEST:
        raise StoreError(f"password: is {plural(len(password), 'character')} long, expected {SHORTEST} to {LONGEST}")
    salt = secrets.token_bytes(16)
    made = _made(password, salt, LOG_COST, BLOCK, PARALLEL)
    parts = (base64.b64encode(one).decode() for one in (salt, made))
    return "$".join(("scrypt", str(LOG_COST), str(BLOCK), str(PARALLEL), *parts))


def is_password(password: str, kept: str | None) -> bool:
    """Whether this is the password of which that was kept; no, and as slowly, where none was."""
    _, cost, block, parallel, salt, made = (kept or NOBODYS).split("$")
    given = _made(password[: LONGEST + 1], base64.b64decode(salt), int(cost), int(block), int(parallel))
    return compare_digest(given, base64.b64decode(made)) and kept is not None


def _made(password: str, salt: bytes, log_cost: int, block: int, parallel: int) -> bytes:
    data = password.encode("utf-8", "surrogatepass")
    with at_once:
        return scrypt(data, salt=salt, n=1 << log_cost, r=block, p=parallel, maxmem=MEMORY, dklen=32)
