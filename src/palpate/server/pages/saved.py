"""What a page says after a form was sent: one of these sentences, by a word in the address."""

from __future__ import annotations

from collections.abc import Mapping

from fastapi import Request

__all__ = ["saved"]

SENTENCES: Mapping[str, str] = {
    "describe": "The description was saved.",
    "know": "What is known was saved.",
    "replaced": "What is known was saved, in place of what the same source said of it before.",
    "forget": "It is no longer told.",
    "merge": "The two are one object now.",
    "split": "It is an object of its own again.",
    "undo": "The change was taken back.",
    "cancelled": "The upload was cancelled: nothing of it was kept.",
    "again": "It was known already: it was kept before, and who sees it did not change.",
}


def saved(request: Request) -> str | None:
    """The sentence that an address asks for; None where it asks for none."""
    return SENTENCES.get(request.query_params.get("saved", ""))
