"""What the service says of itself: its OpenAPI document."""

from __future__ import annotations

from http import HTTPStatus
from typing import Any

from fastapi import FastAPI

from palpate.server.links import add_links
from palpate.server.problems import MEDIA_TYPE

__all__ = ["Described"]

FIRST_ERROR = 400
OF_BODIES = (408, 413)
"""A body can be too slow or too large before anything reads it."""


class Described(FastAPI):
    """An application whose document tells the form of its errors, not plain JSON, and where answers lead."""

    def openapi(self) -> dict[str, Any]:
        """The document."""
        found = super().openapi()
        for operations in found["paths"].values():
            for operation in operations.values():
                _describe(operation)
        add_links(found)
        return found


def _describe(operation: dict[str, Any]) -> None:
    answers = operation["responses"]
    if "requestBody" in operation:
        for status in OF_BODIES:
            answers.setdefault(str(status), {"description": HTTPStatus(status).phrase, "content": _problem()})
    for status, answer in answers.items():
        if int(status) >= FIRST_ERROR:
            answer["content"] = _problem()


def _problem() -> dict[str, Any]:
    return {MEDIA_TYPE: {"schema": {"$ref": "#/components/schemas/Problem"}}}
