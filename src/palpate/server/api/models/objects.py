"""The forms of objects, and of what was changed about them."""

from __future__ import annotations

from typing import Any

from palpate.server.api.models.basics import Strict, Undoable
from palpate.server.api.models.entries import Entry

__all__ = ["Change", "Known", "Object", "ThingName"]


class ThingName(Strict):
    """An object by its dataset and its name there."""

    dataset: str
    name: str


class Known(Strict):
    """What is known of a property of an object, and from where."""

    entry: Entry
    source: str


class Image(Strict):
    """A picture of an object."""

    name: str
    media_type: str
    url: str


class Object(ThingName):
    """An object with what is known of it."""

    common_name: str | None
    maker: str | None
    aliases: list[str]
    attributes: dict[str, Any]
    known: list[Known]
    images: list[Image]
    merged: list[ThingName]
    recordings: int
    url: str


class Change(Undoable):
    """A change of an object: what was there before and after, and whether it was taken back."""

    what: str
    detail: Any
