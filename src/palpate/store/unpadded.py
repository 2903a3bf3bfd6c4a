"""Bytes as text that stands in addresses and cookies: base64 without the signs that fill it up."""

from __future__ import annotations

from base64 import urlsafe_b64decode, urlsafe_b64encode

__all__ = ["from_unpadded", "to_unpadded"]


def to_unpadded(data: bytes) -> str:
    """Bytes as letters, digits, hyphens and underscores.

    Examples
    --------
    >>> to_unpadded(b"mugs"), from_unpadded("bXVncw")
    ('bXVncw', b'mugs')
    """
    return urlsafe_b64encode(data).decode().rstrip("=")


def from_unpadded(text: str) -> bytes:
    """Undo `to_unpadded`; ValueError where somebody else has written it."""
    return urlsafe_b64decode(text + "=" * (-len(text) % 4))
