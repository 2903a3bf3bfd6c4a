"""What recordings add to the description of an object: what nobody has said yet, and no person has taken away."""

from __future__ import annotations

import json
from collections.abc import Collection
from typing import Any

from sqlalchemy import Connection, select

from palpate.store import schema
from palpate.store.content import to_json
from palpate.store.records import ThingRef

__all__ = ["ADDED", "CHANGED", "OF_ARCHIVES", "contradictions", "joined_things", "taken_away", "without"]

ADDED, CHANGED = "added", "changed"
"""What the audit calls that a person has put an object into the store, and has changed what is said of it."""
OF_ARCHIVES = "archive "
"""Who says what comes with an archive, which is what recordings and persons say elsewhere."""
Part = tuple[tuple[str, ...], str]
"""Where a part of a description stands, and what it says, as JSON."""


def joined_things(known: ThingRef, other: ThingRef) -> ThingRef:
    """What is known of an object, completed by what else is said: what was known first stays."""
    names = [*known.aliases, *other.aliases]
    if known.common_name and other.common_name and other.common_name != known.common_name:
        names.append(other.common_name)
    return ThingRef(
        known.dataset,
        known.id,
        known.maker or other.maker,
        known.common_name or other.common_name,
        {**other.attributes, **known.attributes},
        tuple(dict.fromkeys(names)),
    )


def contradictions(known: ThingRef, other: ThingRef) -> dict[str, Any]:
    """What another description says otherwise."""
    found: dict[str, Any] = {}
    if known.maker and other.maker and known.maker != other.maker:
        found["maker"] = other.maker
    for key, value in other.attributes.items():
        if key in known.attributes and to_json(known.attributes[key]) != to_json(value):
            found[f"attributes.{key}"] = value
    return found


def taken_away(connection: Connection, row: int) -> set[Part]:
    """What a person has removed from the description of an object, or has said and taken back."""
    audit = schema.audit.c
    asked = select(audit.detail, audit.undone_us).where(audit.thing_id == row, audit.what == CHANGED)
    found = set()
    for detail, undone_us in connection.execute(asked):
        side = "before" if undone_us is None else "after"
        found |= {(tuple(part["field"]), to_json(part[side])) for part in json.loads(detail) if side in part}
    return found


def without(known: ThingRef, joined: ThingRef, taken: Collection[Part]) -> ThingRef:
    """A completed description without what was taken away; what is known stays.

    Examples
    --------
    >>> known, joined = ThingRef("ycb", "mug"), ThingRef("ycb", "mug", maker="Acme", common_name="cup")
    >>> without(known, joined, {(("maker",), '"Acme"')}).common_name
    'cup'
    """

    def kept(value: Any, *field: str) -> bool:
        return (field, to_json(value)) not in taken

    attributes = {
        name: value
        for name, value in joined.attributes.items()
        if name in known.attributes or kept(value, "attributes", name)
    }
    return ThingRef(
        known.dataset,
        known.id,
        joined.maker if known.maker or kept(joined.maker, "maker") else None,
        joined.common_name if known.common_name or kept(joined.common_name, "common_name") else None,
        attributes,
        tuple(name for name in joined.aliases if name in known.aliases or kept(name, "aliases", name)),
    )
