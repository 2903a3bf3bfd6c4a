"""What is said of an object, as far as somebody may know it.

Recordings complete the description of their object, and some of them not everybody sees. A word is shown where a person
has said it to who looks (see `palpate.store.viewing`), or a recording has that is seen, or where all that was done with
the object is seen.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

from sqlalchemy import Connection, exists, not_, or_, select

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.content import to_json
from palpate.store.json_columns import HoldsText
from palpate.store.records import ThingRef
from palpate.store.sayings import is_seen
from palpate.store.viewing import Viewer

__all__ = ["Part", "hidden_parts", "of_mixed", "seen_names", "seen_refs", "unsaid"]

Part = tuple[tuple[str, ...], str]
"""Where a part of a description stands, and what it says, as JSON."""


def seen_refs(connection: Connection, viewer: Viewer, things: Mapping[int, ThingRef]) -> Mapping[int, ThingRef]:
    """Objects by their rows, with what a viewer may know of each."""
    if viewer.everything:
        return things
    hidden = hidden_parts(connection, viewer, {row: set(_parts(ref)) for row, ref in things.items()})
    return {row: _without(ref, hidden[row]) if hidden[row] else ref for row, ref in things.items()}


def hidden_parts(connection: Connection, viewer: Viewer, every: Mapping[int, set[Part]]) -> Mapping[int, set[Part]]:
    """Those parts, by rows of objects, that a viewer may not know."""
    left = unsaid(connection, viewer, every)
    said = _described(connection, viewer, [row for row, parts in left.items() if parts])
    doubtful = {row: parts - said[row] if row in said else parts for row, parts in left.items()}
    mixed = of_mixed(connection, viewer, [row for row, parts in doubtful.items() if parts])
    return {row: parts if row in mixed else set() for row, parts in doubtful.items()}


def seen_names(connection: Connection, viewer: Viewer, names: Mapping[int, str | None]) -> Mapping[int, str | None]:
    """Common names of objects by their rows, as `seen_refs` gives them; quick, as each list asks for it."""
    if viewer.everything:
        return names
    parts: dict[int, set[Part]] = {
        row: {(("common_name",), to_json(name))} for row, name in names.items() if name is not None
    }
    doubtful = [row for row, left in unsaid(connection, viewer, parts).items() if left]
    things, said = schema.things.c, schema.descriptions.c
    is_name = or_(said.common_name == things.common_name, HoldsText(said.aliases, things.common_name))
    described = exists().where(said.thing_id == things.id, is_name, is_seen(viewer))
    for some in chunks(doubtful):
        known = set(connection.scalars(select(things.id).where(things.id.in_(some), described)))
        doubtful = [row for row in doubtful if row not in known]
    hidden = of_mixed(connection, viewer, doubtful)
    return {row: None if row in hidden else name for row, name in names.items()}


def _parts(ref: ThingRef) -> Iterator[Part]:
    for name in ("maker", "common_name"):
        if getattr(ref, name) is not None:
            yield (name,), to_json(getattr(ref, name))
    yield from ((("attributes", name), to_json(value)) for name, value in ref.attributes.items())
    yield from ((("aliases", name), to_json(name)) for name in ref.aliases)


def _without(ref: ThingRef, parts: Collection[Part]) -> ThingRef:
    hidden = {field for field, _ in parts}
    return replace(
        ref,
        maker=None if ("maker",) in hidden else ref.maker,
        common_name=None if ("common_name",) in hidden else ref.common_name,
        attributes={name: value for name, value in ref.attributes.items() if ("attributes", name) not in hidden},
        aliases=tuple(name for name in ref.aliases if ("aliases", name) not in hidden),
    )


def unsaid(connection: Connection, viewer: Viewer, parts: Mapping[int, set[Part]]) -> dict[int, set[Part]]:
    """Those parts, by rows of objects, that no person has said to a viewer."""
    audit, left = schema.audit.c, {row: set(some) for row, some in parts.items()}
    for some in chunks([row for row, one in parts.items() if one]):
        heard = (audit.thing_id.in_(some), viewer.hears())
        for row, detail in connection.execute(select(audit.thing_id, audit.detail).where(*heard)):
            left[row] -= {(tuple(one["field"]), to_json(one["after"])) for one in _changes(detail) if "after" in one}
    return left


def _changes(detail: str) -> list[Any]:
    try:
        found = json.loads(detail)
    except ValueError:
        # damaged: nobody has said anything by it
        return []
    return [one for one in found if isinstance(one, dict) and "field" in one] if isinstance(found, list) else []


def _described(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> Mapping[int, set[Part]]:
    """What recordings that are seen say of objects, by their rows; of attributes none keeps what it has said."""
    said, found = schema.descriptions.c, defaultdict[int, set[Part]](set)
    for some in chunks(rows):
        asked = select(said.thing_id, said.maker, said.common_name, said.aliases)
        for row in connection.execute(asked.where(said.thing_id.in_(some), is_seen(viewer))):
            names = [name for name in (row.common_name, *json.loads(row.aliases)) if name is not None]
            # what was not the first common name became an alias
            found[row.thing_id].update((field, to_json(name)) for name in names for field in _fields(name))
            found[row.thing_id].add((("maker",), to_json(row.maker)))
    return found


def _fields(name: str) -> tuple[tuple[str, ...], ...]:
    return ("common_name",), ("aliases", name)


def of_mixed(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> set[int]:
    """Rows of those objects with which something was done that is not seen."""
    things, found = schema.things.c, set[int]()
    for some in chunks(rows):
        asked = select(things.id).where(things.id.in_(some), not_(viewer.sees_all()))
        found.update(connection.scalars(asked))
    return found
