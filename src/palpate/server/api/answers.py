"""Answers: pages of lists, with the fields that were asked for, and the address of the next page."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from fastapi import Request
from fastapi.responses import Response

from palpate.server.api.queries import PageQuery
from palpate.server.problems import problem
from palpate.store.content import to_json

__all__ = ["answer", "finite", "page"]

Plain = Mapping[str, Any]


class Answer(Response):
    """JSON as the store writes it."""

    media_type = "application/json"

    def render(self, content: Any) -> bytes:
        """The bytes."""
        return to_json(content).encode("utf-8", "replace")


def answer(plain: Any, status: int = 200, headers: Mapping[str, str] | None = None) -> Response:
    """An answer of one item."""
    return Answer(plain, status, headers)


def page(request: Request, query: PageQuery, items: Iterable[Plain], cursor: str | None) -> Response:
    """A page of a list, with the next one in the header ``Link`` too."""
    found = [_chosen(item, query.fields) for item in items]
    headers = {}
    if cursor is not None:
        headers["Link"] = f'<{request.url.include_query_params(cursor=cursor)}>; rel="next"'
    return Answer({"items": found, "next": cursor}, headers=headers)


def _chosen(item: Plain, fields: Sequence[str]) -> Plain:
    if not fields:
        return item
    asked = ",".join(fields)
    names = [name for name in asked.split(",") if name]
    unknown = [name for name in names if name not in item]
    if unknown or not names:
        told = f"found {asked!r}, expected some of {', '.join(item)}"
        raise problem(422, f"query.fields: {told}", [{"field": "query.fields", "detail": told}])
    return {name: item[name] for name in names}


def finite(values: Any) -> Any:
    """Nested lists with null in the place of what JSON has no word for."""
    if isinstance(values, list):
        return [finite(value) for value in values]
    return None if isinstance(values, float) and not math.isfinite(values) else values
