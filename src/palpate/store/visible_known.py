"""What is known of objects that count as others, as far as somebody sees these objects."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Mapping, Sequence

from sqlalchemy import select, tuple_

from palpate.store import schema
from palpate.store.chunks import chunks
from palpate.store.legible import reading
from palpate.store.store import Store
from palpate.store.things import Known, known_of
from palpate.store.viewing import Viewer

__all__ = ["known_of_merged"]

Name = tuple[str, str]
AT_ONCE = 200


def known_of_merged(store: Store, viewer: Viewer, heads: Collection[Name]) -> Mapping[Name, Sequence[Known]]:
    """What is known of the objects that are merged into others, by dataset and name of these, the first told first.

    The same object is known by either name: where nothing is said of the one that counts, this holds of it.
    """
    known, part, head = schema.thing_properties, schema.things, schema.things.alias("head")
    asked = (
        select(known.c.property, known.c.source, known.c.document, part.c.dataset, part.c.name)
        .add_columns(head.c.dataset.label("of_dataset"), head.c.name.label("of_name"))
        .join(part, part.c.id == known.c.thing_id)
        .join(head, head.c.id == part.c.merged_into)
        .where(viewer.things())
        .order_by(known.c.id)
    )
    ordered, found = sorted(heads), defaultdict[Name, list[Known]](list)
    with reading(store.engine) as connection:
        for some in chunks(ordered, AT_ONCE):
            for row in connection.execute(asked.where(tuple_(head.c.dataset, head.c.name).in_(some))).mappings():
                found[row["of_dataset"], row["of_name"]].append(known_of(row, row))
    return found
