"""What is said of an object, as far as somebody may know it.

Recordings complete the description of their object, and some of them not everybody sees. Where all that was done with
an object is seen, it is shown as it is described. Else what is shown is made of what is seen alone, see
`palpate.store.told_words`: were the description only filtered, whoever sends a recording with a guess would learn
whether it is the description's.
"""

from __future__ import annotations

import json
from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence

from sqlalchemy import Connection, exists, func, not_, or_, select, tuple_

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.completing import ADDED, CHANGED
from palpate.store.content import to_json
from palpate.store.legible import legible
from palpate.store.records import ThingRef
from palpate.store.sayings import is_seen
from palpate.store.told_words import Description, Line, Words, changes_of
from palpate.store.viewing import Viewer

__all__ = ["Part", "hidden_parts", "of_mixed", "rows_named", "seen_names", "seen_refs", "unsaid"]

AT_ONCE = 200
Part = tuple[tuple[str, ...], str]
"""Where a part of a description stands, and what it says, as JSON."""


def seen_refs(connection: Connection, viewer: Viewer, things: Mapping[int, ThingRef]) -> Mapping[int, ThingRef]:
    """Objects by their rows, with what a viewer may know of each."""
    if viewer.everything:
        return things
    words = _words(connection, viewer, list(things))
    seen = {row: words[row].of(ref) for row, ref in things.items()}
    mixed = of_mixed(connection, viewer, [row for row, ref in things.items() if not _is_same(seen[row], ref)])
    return {row: seen[row] if row in mixed else ref for row, ref in things.items()}


def seen_names(connection: Connection, viewer: Viewer, names: Mapping[int, str | None]) -> Mapping[int, str | None]:
    """Common names of objects by their rows, as `seen_refs` gives them; quick, as each list asks for it."""
    if viewer.everything:
        return names
    told = _told_alike(connection, viewer, list(names))
    words = _words(connection, viewer, [row for row in names if row not in told])
    seen = {row: one.common_name for row, one in words.items()}
    mixed = of_mixed(connection, viewer, [row for row, name in seen.items() if name != names[row]])
    return {row: seen[row] if row in mixed else name for row, name in names.items()}


def _told_alike(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> set[int]:
    """Rows of those objects of which all, seen or not, say one common name, or none, and no person anything."""
    things, said, line, found = schema.things.c, schema.descriptions.c, schema.audit.c, set[int]()
    own, one = said.thing_id == things.id, func.coalesce(things.common_name, "")
    other = exists().where(own, said.common_name != one)
    seen = exists().where(own, said.common_name == things.common_name, is_seen(viewer))
    by_person = exists().where(line.thing_id == things.id, line.what.in_((ADDED, CHANGED)))
    alike = (not_(by_person), not_(other), or_(things.common_name.is_(None), seen))
    for some in chunks(rows):
        found.update(connection.scalars(select(things.id).where(things.id.in_(some), *alike)))
    return found


def _is_same(one: ThingRef, other: ThingRef) -> bool:
    # numbers that are equal may be of different types
    return to_json(vars(one)) == to_json(vars(other))


def _words(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> Mapping[int, Words]:
    """What a viewer knows to be said of objects, by their rows."""
    lines = _heard(connection, viewer, rows)
    described = _described(connection, viewer, rows, lines)
    found = {row: Words(described.get(row, ())) for row in rows}
    for row, some in lines.items():
        for line in some:
            found[row].hear(line)
    return found


def _heard(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> Mapping[int, Sequence[Line]]:
    """What persons have said to a viewer, by rows of objects, the first first."""
    audit, found = schema.audit.c, defaultdict[int, list[Line]](list)
    for some in chunks(rows):
        asked = select(audit.thing_id, audit.at_us, audit.detail).where(audit.thing_id.in_(some), viewer.hears())
        for row, at_us, detail in connection.execute(asked.order_by(audit.id)):
            found[row].append(Line(at_us, changes_of(detail)))
    return found


def _described(
    connection: Connection, viewer: Viewer, rows: Sequence[int], lines: Mapping[int, Sequence[Line]]
) -> Mapping[int, Sequence[Description]]:
    """What recordings that are seen say of objects, by their rows, the first that came first."""
    said, found = schema.descriptions.c, defaultdict[int, list[tuple[int, Description]]](list)
    columns = (said.id, said.thing_id, said.maker, said.common_name, said.aliases)
    for some in chunks(rows):
        for row in connection.execute(select(*columns).where(said.thing_id.in_(some), is_seen(viewer))):
            with legible(f"description {row.id}"):
                one = Description(0, row.maker, row.common_name, tuple(json.loads(row.aliases)))
            found[row.thing_id].append((row.id, one))
    # one that nobody has changed needs no order
    several = [number for row, some in found.items() if len(some) > 1 or row in lines for number, _ in some]
    came = _came(connection, viewer, several)
    return {row: [one for _, one in sorted(_placed(some, came), key=lambda one: one[0])] for row, some in found.items()}


def _placed(
    described: Sequence[tuple[int, Description]], came: Mapping[int, tuple[int, int]]
) -> Iterator[tuple[int, Description]]:
    for number, one in described:
        place, said_us = came.get(number, (number, 0))
        yield place, Description(said_us, one.maker, one.common_name, one.aliases)


def _came(connection: Connection, viewer: Viewer, descriptions: Sequence[int]) -> Mapping[int, tuple[int, int]]:
    """Row and time of the first recording that is seen, by what it says: a hidden one may have said it before."""
    recordings, found = schema.recordings, dict[int, tuple[int, int]]()
    number = recordings.c.description_id
    for some in chunks(descriptions):
        asked = select(number, func.min(recordings.c.id), func.min(recordings.c.uploaded_us))
        asked = asked.where(number.in_(some), viewer.of(recordings)).group_by(number)
        found |= {row[0]: (row[1], row[2]) for row in connection.execute(asked)}
    return found


def hidden_parts(connection: Connection, viewer: Viewer, every: Mapping[int, set[Part]]) -> Mapping[int, set[Part]]:
    """Those parts, by rows of objects, that no person has said to a viewer who does not see all of the object."""
    left = unsaid(connection, viewer, every)
    mixed = of_mixed(connection, viewer, [row for row, parts in left.items() if parts])
    return {row: parts if row in mixed else set() for row, parts in left.items()}


def unsaid(connection: Connection, viewer: Viewer, parts: Mapping[int, set[Part]]) -> dict[int, set[Part]]:
    """Those parts, by rows of objects, that no person has said to a viewer."""
    left = {row: set(some) for row, some in parts.items()}
    for row, lines in _heard(connection, viewer, [row for row, one in parts.items() if one]).items():
        changes = (one for line in lines for one in line.changes if "after" in one)
        left[row] -= {(tuple(one["field"]), to_json(one["after"])) for one in changes}
    return left


def rows_named(connection: Connection, names: Sequence[tuple[str, str]]) -> dict[tuple[str, str], int]:
    """Rows of objects by dataset and name, in their order."""
    columns, rows = schema.things.c, dict[tuple[str, str], int]()
    for some in chunks(names, AT_ONCE):
        asked = select(columns.dataset, columns.name, columns.id)
        found = connection.execute(asked.where(tuple_(columns.dataset, columns.name).in_(some)))
        rows |= {(dataset, name): row for dataset, name, row in found}
    return {name: rows[name] for name in names}


def of_mixed(connection: Connection, viewer: Viewer, rows: Sequence[int]) -> set[int]:
    """Rows of those objects with which something was done that is not seen."""
    things, found = schema.things.c, set[int]()
    for some in chunks(rows):
        asked = select(things.id).where(things.id.in_(some), not_(viewer.sees_all()))
        found.update(connection.scalars(asked))
    return found
