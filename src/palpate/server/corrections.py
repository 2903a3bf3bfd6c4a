"""Changing what is said of an object, over the network: who may, and under whose name it is noted.

A curator may change what they see. An owner may where all that was measured of the object is theirs, and nobody else
has described it. Each change is noted with who made it and what was there before, and can be taken back.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from palpate.errors import choices
from palpate.server.plausible import check_plausible
from palpate.server.problems import problem, problem_of_store
from palpate.server.security.accounts import Account, Role
from palpate.store.audit import ADDED, CHANGED, MERGED, UNDOABLE, Change
from palpate.store.changing_seen import ChangedMeanwhileError, change_seen, seen_history, undo_seen
from palpate.store.entries import Entry
from palpate.store.errors import StoreError
from palpate.store.merging import merge_things, split_thing
from palpate.store.name_shown import who_learns_name
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing
from palpate.store.visible_things import is_all_theirs, visible_thing

__all__ = ["Corrections", "may_change"]

TOLD = (ADDED, CHANGED, MERGED)
"""Of the audit; what recordings say otherwise may stand in a private one."""


def may_change(store: Store, who: Account, thing: ThingRef) -> bool:
    """Whether somebody who sees an object may change what is said of it."""
    if who.role >= Role.CURATOR:
        return True
    return who.role >= Role.OWNER and who.name is not None and is_all_theirs(store, who.name, thing)


@dataclass(frozen=True)
class Corrections:
    """Changes of one object by somebody; each raises a 403 where they may not, and a StoreError where it is wrong."""

    store: Store
    who: Account
    thing: Thing

    def describe(self, fields: Mapping[str, Any], version: str | None = None) -> None:
        """Other words for maker, common name, attributes or aliases; of what is not seen nothing changes.

        Where it is not of this version any more, that is a 409.
        """
        try:
            self._change(lambda thing: thing.described(**fields), version)
        except ChangedMeanwhileError as error:
            raise problem(409, str(error)) from None

    def know(self, entry: Entry, source: str) -> None:
        """Tell what a source says of a property."""
        self._check(self.thing.ref)
        check_plausible(self.store, entry, self.who.viewer)
        self._change(lambda thing: thing.knowing(entry, source))

    def forget(self, property: str, source: str | None) -> None:
        """Tell no longer what a source, or any source, says of a property; where none does, that is refused."""

        def without(thing: Thing) -> Thing:
            left = thing.without(property, source)
            if left.known == thing.known:
                raise StoreError(_none_known(thing, property, source))
            return left

        self._change(without)

    def merge(self, dataset: str, name: str, *, shows_name: bool = False) -> ThingRef:
        """Let it count as another one, which is given back.

        Where others learn the name of that one by this, it is done only where that is wanted.
        """
        self._check(self.thing.ref)
        into = visible_thing(self.store, self.who.viewer, dataset, name)
        if into is None:
            raise problem(422, f"into: object {dataset}/{name}: there is none, or none that you may see")
        self._check(into.ref)
        others = None if shows_name else who_learns_name(self.store, self.who.viewer, self.thing.ref, into.ref)
        if others is not None:
            learn = f"{others} would learn by this that there is {dataset}/{name}, which they do not see"
            raise problem_of_store(StoreError(f"shows_name: {learn}; expected yes, where that is wanted"))
        merge_things(self.store, self.thing.ref, into.ref, who=self.who.name)
        return into.ref

    def split(self) -> None:
        """Let it count as one of its own again."""
        self._check(self.thing.ref)
        split_thing(self.store, self.thing.ref, who=self.who.name)

    def undo(self) -> None:
        """Take back the last change that holds and is seen."""
        self._check(self.thing.ref)
        undo_seen(self.store, self.who.viewer, self.thing.ref, who=self.who.name)

    def history(self) -> list[Change]:
        """Who changed what, the last first."""
        self._check(self.thing.ref)
        return [one for one in reversed(seen_history(self.store, self.who.viewer, self.thing.ref)) if one.what in TOLD]

    def last(self) -> Change | None:
        """The last change that holds, which `undo` takes back."""
        holds = (one for one in self.history() if one.what in UNDOABLE and one.undone_at is None)
        return next(holds, None)

    def _change(self, edit: Callable[[Thing], Thing], version: str | None = None) -> None:
        self._check(self.thing.ref)
        change_seen(self.store, self.who.viewer, self.thing.ref, edit, who=self.who.name, version=version)

    def _check(self, thing: ThingRef) -> None:
        if not may_change(self.store, self.who, thing):
            whose = "for curators to change, or for who owns all recordings of it and alone has described it"
            told = f"object {thing.dataset}/{thing.id}: is {whose}"
            raise problem(403, told)


def _none_known(thing: Thing, property: str, source: str | None) -> str:
    """Why nothing is forgotten, and what could be."""
    of = [one for one in thing.known if one.entry.property == property]
    if of:
        return f"source: {source!r} says nothing of {property!r}; {choices(one.source for one in of)}"
    names = dict.fromkeys(one.entry.property for one in thing.known if one.entry.property is not None)
    told = choices(names) if names else "nothing is known of this object"
    return f"property: nothing is known of {property!r}; {told}"
