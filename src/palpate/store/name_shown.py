"""Whether others learn the name of an object by it that another one, which they see, counts as it."""

from __future__ import annotations

from sqlalchemy import select

from palpate.store import schema
from palpate.store.legible import reading
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_things import rows_of, visible_thing

__all__ = ["who_learns_name"]

PUBLIC, LAB = Viewer(), Viewer(lab=True)


def who_learns_name(store: Store, viewer: Viewer, thing: ThingRef, into: ThingRef) -> str | None:
    """Who sees an object and would see the name of another one by a merge into it, in words; None where nobody would.

    What the viewer does not see of the two is not looked at, so that it tells them nothing of that.
    """
    for some, words in ((PUBLIC, "everybody"), (LAB, "everybody with an account")):
        if _is_seen(store, some, thing):
            return None if _is_seen(store, some, into) else words
    others = _owners(store, viewer, thing) - _owners(store, viewer, into)
    return " and ".join(sorted(others)) or None


def _is_seen(store: Store, viewer: Viewer, thing: ThingRef) -> bool:
    return visible_thing(store, viewer, thing.dataset, thing.id) is not None


def _owners(store: Store, viewer: Viewer, thing: ThingRef) -> set[str]:
    """Who sees what was done with an object and is private: who owns it, and who has sent it."""
    names = set[str]()
    with reading(store.engine) as connection:
        for table in (schema.recordings, schema.episodes):
            asked = select(table.c.owner, table.c.uploaded_by).where(table.c.thing_id.in_(rows_of(thing)))
            rows = connection.execute(asked.where(viewer.of(table)).distinct())
            names |= {name for row in rows for name in row if name is not None}
    return names
