"""Parameters that an address gives more than once: of most the last alone would count, and nobody would notice."""

from __future__ import annotations

from collections import Counter

from fastapi import Request

from palpate.server.problems import problem

__all__ = ["LISTS", "check_once"]

LISTS = frozenset({"colour", "fields", "known", "label", "recording"})
"""What may be given several times; of filters all hold then."""


async def check_once(request: Request) -> None:
    """Refuse, with a 422, what is no list and is given several times, as ``?action=weighing&action=knocking``."""
    counts = Counter(name for name, _ in request.query_params.multi_items())
    again = [name for name, count in counts.items() if count > 1 and name not in LISTS]
    if again:
        told = [{"field": f"query.{name}", "detail": f"is given {counts[name]} times, expected once"} for name in again]
        raise problem(422, "; ".join(f"{name}: {one['detail']}" for name, one in zip(again, told, strict=True)), told)
