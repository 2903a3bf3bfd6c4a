"""Filters of lists: which there are, and how they stand in an address."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import datetime

from palpate.client.errors import RefusedError
from palpate.errors import choices, near

__all__ = ["FILTERS", "Asked", "parameters"]

Asked = str | bool | datetime | Sequence[str] | None

MEASURED = (
    *("object", "dataset", "category", "material", "known", "label", "action", "property", "device", "gripper"),
    *("setup", "owner", "since", "until", "ground_truth", "text", "sort", "order", "fields"),
)
FILTERS: Mapping[str, Sequence[str]] = {
    "/objects": ("text", "dataset", "known", "action", "property", "gripper", "fields"),
    "/recordings": MEASURED,
    "/entries": MEASURED,
    "/episodes": ("object", "dataset", "since", "until", "fields"),
}
"""What each list of the service can be asked."""


def parameters(path: str, filters: Mapping[str, Asked]) -> list[tuple[str, str]]:
    """What is asked of a list, as parameters of an address.

    Raises
    ------
    RefusedError
        If the list has no such filter, or something else is given than a filter can be.

    Examples
    --------
    >>> parameters("/objects", {"known": ["material:wood", "category:mug"], "text": None})
    [('known', 'material:wood'), ('known', 'category:mug')]
    """
    names = FILTERS[path]
    for name in filters:
        if name not in names:
            raise RefusedError(
                f"filter {name!r}: {path[1:]} have none of that name{near(name, names)}; {choices(names)}"
            )
    return [(name, text) for name, value in filters.items() for text in _texts(name, value)]


def _texts(name: str, value: Asked) -> list[str]:
    if value is None:
        return []
    if isinstance(value, bool):
        return [str(value).lower()]
    if isinstance(value, datetime):
        return [value.isoformat()]
    texts = [value] if isinstance(value, str) else value
    if not isinstance(texts, list | tuple) or not all(isinstance(text, str) for text in texts):
        told = "expected text, a list of texts, a truth value or a moment"
        raise RefusedError(f"filter {name!r}: found {value!r}, {told}")
    return list(texts)
