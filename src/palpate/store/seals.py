"""Seals, by which a list finds out that a document is the one that was written, without reading the signals.

The digest of a recording covers its document, its signals and its log; the seal covers digest and document.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from hashlib import sha256
from typing import Any
from uuid import UUID

from palpate.store.errors import DamagedError
from palpate.store.legible import legible

__all__ = ["Named", "checked_document", "recording_name", "seal_of", "sealed_document"]


def seal_of(digest: bytes, document: str) -> bytes:
    """SHA-256 of the digest and the document of a recording."""
    return sha256(digest + document.encode()).digest()


def sealed_document(row: Mapping[Any, Any]) -> Mapping[str, Any]:
    """The document of a row of recordings.

    Parameters
    ----------
    row
        With ``uuid``, ``digest``, ``document`` and ``seal``; and ``dataset`` and ``name`` of the object, None where
        there is none.

    Raises
    ------
    DamagedError
        If it is not the one that was written, or is of another object.
    """
    where = Named(row["uuid"])
    with legible(where):
        if seal_of(row["digest"], row["document"]) != row["seal"]:
            raise DamagedError(f"{where}: is not what was written")
        plain: Mapping[str, Any] = json.loads(row["document"])
        if plain["thing"] != [row["dataset"], row["name"]]:
            raise DamagedError(f"{where}: refers to another object than its content does")
    return plain


class Named:
    """A recording by its id, whose name is put together only where something is wrong with it."""

    def __init__(self, uuid: bytes) -> None:
        self._uuid = uuid

    def __str__(self) -> str:
        return recording_name(self._uuid)


def recording_name(uuid: bytes) -> str:
    """What a recording is called, also where its id is none."""
    return f"recording {UUID(bytes=uuid) if len(uuid) == 16 else uuid.hex()}"


def checked_document(table: str, digest: bytes, document: str) -> Any:
    """The document of a setup, device or layout, which stands under its own digest.

    Raises
    ------
    DamagedError
        If it is not the one of its digest.
    """
    with legible(f"{table} {digest.hex()}"):
        if sha256(document.encode()).digest() != digest:
            raise DamagedError(f"{table} {digest.hex()}: its content is not the one of its digest")
        return json.loads(document)
