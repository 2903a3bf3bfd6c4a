"""What recordings of an archive say of their objects: where not all see all of one, each says what it has said itself.

Read back from an archive a recording would otherwise say all that is known of its object, and show it to who sees the
recording. What else is known of the object the archive has beside the recordings.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence

from sqlalchemy import Connection, select

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.legible import legible
from palpate.store.records import Recording, ThingRef
from palpate.store.viewing import Viewer
from palpate.store.visible_words import of_mixed

__all__ = ["things_said"]


def things_said(connection: Connection, recordings: Sequence[Recording]) -> Mapping[str, ThingRef]:
    """Objects that the public does not see whole, as recordings describe them themselves, by digests of these."""
    columns, rows = schema.recordings.c, dict[str, tuple[int, int | None]]()
    for some in chunks([bytes.fromhex(one.digest) for one in recordings]):
        asked = select(columns.digest, columns.thing_id, columns.description_id).where(columns.digest.in_(some))
        rows |= {digest.hex(): (thing, said) for digest, thing, said in connection.execute(asked)}
    mixed = of_mixed(connection, Viewer(), list({thing for thing, _ in rows.values()}))
    hidden = {digest: said for digest, (thing, said) in rows.items() if thing in mixed}
    found = _descriptions(connection, list({said for said in hidden.values() if said is not None}))
    return {one.digest: _held(one.thing, found.get(hidden[one.digest])) for one in recordings if one.digest in hidden}


def _descriptions(connection: Connection, rows: Sequence[int]) -> dict[int | None, tuple[str | None, list[str | None]]]:
    """Maker and names that descriptions say, by their rows."""
    said, found = schema.descriptions.c, dict[int | None, tuple[str | None, list[str | None]]]()
    for some in chunks(rows):
        asked = select(said.id, said.maker, said.common_name, said.aliases).where(said.id.in_(some))
        for row in connection.execute(asked):
            with legible(f"description {row.id}"):
                found[row.id] = row.maker, [row.common_name, *json.loads(row.aliases)]
    return found


def _held(thing: ThingRef, said: tuple[str | None, list[str | None]] | None) -> ThingRef:
    """What a recording says of an object that still holds, so that the rest completes it to what it was."""
    maker, names = said or (None, list[str | None]())
    return ThingRef(
        thing.dataset,
        thing.id,
        maker=thing.maker if maker == thing.maker else None,
        common_name=thing.common_name if thing.common_name in names else None,
        aliases=tuple(name for name in names if name in thing.aliases),
    )
