"""The forms of uploads: what is known already, and what became of each recording."""

from __future__ import annotations

from typing import Annotated, Literal
from uuid import UUID

from pydantic import Field

from palpate.server.api.models.basics import Strict

__all__ = ["Batch", "Digests", "KnownRecordings", "Receipt"]


class Receipt(Strict):
    """What became of a recording: under which id the store has it, and whether it was new there."""

    id: UUID
    digest: str
    new: bool
    notices: list[str]


class BatchField(Strict):
    """A field that is wrong."""

    field: str
    detail: str


class BatchItem(Strict):
    """What became of one recording of a batch: 201 it is new, 200 it is known, 422 it is refused."""

    source: str
    status: Literal[200, 201, 422]
    id: UUID | None
    digest: str | None
    new: bool
    detail: str | None
    errors: list[BatchField]
    notices: list[str]


class Batch(Strict):
    """What became of each recording of a batch, in the order in which they came."""

    items: list[BatchItem]


class Digests(Strict):
    """Recordings by their digests, SHA-256 in hexadecimal digits."""

    digests: list[Annotated[str, Field(pattern="^[0-9a-f]{64}$")]] = Field(max_length=1_000)


class KnownRecordings(Strict):
    """Those recordings that are here, with their ids."""

    known: dict[str, UUID]
