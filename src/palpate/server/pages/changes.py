"""A change of what is said of an object, in words."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from typing import Any

from palpate.store.decoding import entry_from
from palpate.store.entries import Entry

__all__ = ["change_text"]


def change_text(detail: Any, entry_text: Callable[[Entry], str]) -> str:
    """What was added, taken away, or became something else, part by part; or what an object was merged into.

    Examples
    --------
    >>> change_text([{"field": ["common_name"], "after": "cup"}], str)
    'common name: cup added'
    >>> change_text([{"field": ["aliases", "mug"], "before": "mug"}, {"field": ["maker"]}], str)
    'aliases, mug: taken away; maker: taken away'
    >>> change_text([{"field": ["maker"], "before": "Acme", "after": "Acme Ltd"}], str)
    'maker: Acme became Acme Ltd'
    >>> change_text({"into": ["ycb", "025_mug"]}, str)
    'into ycb/025_mug'
    """
    if isinstance(detail, list):
        return "; ".join(_parts(detail, entry_text))
    into = detail.get("into") if isinstance(detail, dict) else None
    return f"into {'/'.join(into)}" if into else ""


def _parts(detail: list[dict[str, Any]], entry_text: Callable[[Entry], str]) -> Iterator[str]:
    for part in detail:
        kind, *rest = part["field"]
        before, after = (_words(kind, part[side], entry_text) if side in part else None for side in ("before", "after"))
        yield f"{', '.join([kind.replace('_', ' '), *rest])}: {_happened(before, after, rest)}"


def _happened(before: str | None, after: str | None, named: Sequence[str]) -> str:
    if before is not None and after is not None:
        return f"{before} became {after}"
    # what was there may be hidden from who reads it, and a name is not told twice
    value, did = (before, "taken away") if after is None else (after, "added")
    return did if value is None or value in named else f"{value} {did}"


def _words(kind: str, value: Any, entry_text: Callable[[Entry], str]) -> str:
    if kind == "known":
        return entry_text(entry_from(value))
    if kind == "images":
        return "a picture"
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)
