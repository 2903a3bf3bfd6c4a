"""Who may see what: conditions that stand in every question of a server, so that nothing is filtered afterwards.

A recording or an episode is seen by all where it is public, by everybody with an account where it is for the lab, and
by its owner, by all who have sent it, and by administrators where it is private or until its embargo ends. A setup is
seen where a recording is that was made with it. An object is seen where something that was done with it is, or where
nothing was done with it yet, or where a person has said something of it that is seen.

Who says something of an object says it to those who see something that was done with it by then, or that is the
speaker's own; and to all where nothing was done with it yet. So nobody learns it by sending something of that name
later, and nobody hides it so.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property, partial

from sqlalchemy import ColumnElement, Select, Table, and_, exists, false, func, not_, or_, select, true, union

from palpate.store import schema
from palpate.store.completing import ADDED, CHANGED, OF_ARCHIVES
from palpate.store.embargo import is_over
from palpate.store.filters import Filter, each_label, things_named
from palpate.store.json_columns import Tells
from palpate.store.registry import now_us
from palpate.store.sayings import knows_name

__all__ = ["Viewer", "VisibleFilter"]


@dataclass(frozen=True)
class Viewer:
    """Somebody who looks at a store.

    Attributes
    ----------
    name
        Of the account, which is that of the owner of recordings; None for the public.
    lab
        Whether what is shared in the lab is seen.
    everything
        Whether all is seen, whoever owns it.

    Examples
    --------
    >>> print(Viewer().of(schema.recordings))  # doctest: +NORMALIZE_WHITESPACE
    recordings.visibility IN (__[POSTCOMPILE_visibility_1])
    AND (recordings.embargoed_us IS NULL OR recordings.embargoed_us <= :embargoed_us_1)
    """

    name: str | None = None
    lab: bool = False
    everything: bool = False

    def of(self, table: Table) -> ColumnElement[bool]:
        """The condition on `schema.recordings` or `schema.episodes` that a row is seen."""
        if self.everything:
            return true()
        # it stands many times in one question, and to put it together takes longer than to look up a row
        if table not in self._of:
            self._of[table] = self._seen(table)
        return self._of[table]

    @cached_property
    def _of(self) -> dict[Table, ColumnElement[bool]]:
        return {}

    def _seen(self, table: Table) -> ColumnElement[bool]:
        shown = ("public", "lab") if self.lab else ("public",)
        open_ = [and_(table.c.visibility.in_(shown), is_over(table, self.now_us))]
        return or_(*open_, *self._own(table))

    def _own(self, table: Table) -> Iterator[ColumnElement[bool]]:
        if self.name is None:
            return
        yield table.c.owner == self.name
        yield table.c.uploaded_by == self.name
        if table is schema.recordings:
            senders = schema.senders.c
            yield table.c.id.in_(select(senders.recording_id).where(senders.name == self.name))

    @cached_property
    def now_us(self) -> int:
        """When they look: all that they ask in one request is told as of one moment."""
        return now_us()

    def things(self) -> ColumnElement[bool]:
        """The condition on `schema.things` that one is seen by itself, whatever is merged into it."""
        return true() if self.everything else self._things

    @cached_property
    def _things(self) -> ColumnElement[bool]:
        tables = (schema.recordings, schema.episodes)
        here = [exists().where(table.c.thing_id == schema.things.c.id, self.of(table)) for table in tables]
        any_ = [exists().where(table.c.thing_id == schema.things.c.id) for table in tables]
        said = exists().where(schema.audit.c.thing_id == schema.things.c.id, self.hears())
        return or_(*here, not_(or_(*any_)), said)

    def hears(self, *, holding: bool = True) -> ColumnElement[bool]:
        """The condition on `schema.audit` that by a line a person has told something that is seen, and still holds."""
        line = schema.audit.c
        holds = (line.what.in_((ADDED, CHANGED)), *([line.undone_us.is_(None)] if holding else []))
        return and_(*holds) if self.everything else and_(*holds, self._is_told)

    @cached_property
    def _is_told(self) -> ColumnElement[bool]:
        line, recordings, episodes = schema.audit.c, schema.recordings, schema.episodes
        before = (recordings.c.thing_id == line.thing_id, recordings.c.uploaded_us <= line.at_us)
        # when an episode came nobody has noted
        nothing = not_(or_(exists().where(*before), exists().where(episodes.c.thing_id == line.thing_id)))
        theirs = func.coalesce(recordings.c.owner, recordings.c.uploaded_by) == line.who
        of_theirs = exists().where(recordings.c.thing_id == line.thing_id, theirs, self.of(recordings))
        told = and_(
            not_(func.coalesce(line.who, "").startswith(OF_ARCHIVES)),
            or_(exists().where(*before, self.of(recordings)), of_theirs),
        )
        own = [] if self.name is None else [line.who == self.name]
        return or_(nothing, told, *own)

    def sees_all(self) -> ColumnElement[bool]:
        """The condition on `schema.things` that all that was done with one is seen."""
        tables = (schema.recordings, schema.episodes)
        # who owns it may be unknown, and then it is neither seen nor not
        unseen = ((table, not_(func.coalesce(self.of(table), false()))) for table in tables)
        return not_(or_(*(exists().where(table.c.thing_id == schema.things.c.id, hidden) for table, hidden in unseen)))

    def heads(self) -> Select[int]:
        """Rows of the objects that are seen and count as one of their own, themselves or by one merged into them."""
        things = schema.things.c
        return select(func.coalesce(things.merged_into, things.id)).where(self.things())

    def setups(self) -> Select[int]:
        """Rows of the setups that are seen."""
        return select(schema.recordings.c.setup_id).where(self.of(schema.recordings)).distinct()


@dataclass(frozen=True)
class VisibleFilter(Filter):
    """A filter that lets through only what somebody may see, also of what an object is known to be."""

    viewer: Viewer = field(default_factory=Viewer)

    def conditions(self) -> Iterator[ColumnElement[bool]]:
        """All but property and labels, on `schema.recordings`."""
        columns = schema.recordings.c
        yield from super(VisibleFilter, replace(self, known={}, thing=None, dataset=None)).conditions()
        if self.thing is not None or self.dataset is not None:
            yield columns.thing_id.in_(things_named(self.thing, self.dataset, partial(knows_name, self.viewer)))
        for name, label in each_label(self.known):
            yield columns.thing_id.in_(known_things(self.viewer, name, label))
        if not self.viewer.everything:
            yield self.viewer.of(schema.recordings)


def known_things(viewer: Viewer, name: str, label: str) -> Select[int]:
    """Rows of objects of which a label is known to a viewer, with those that count as the same object."""
    said, things = schema.thing_properties.c, schema.things
    entries, recordings = schema.entries.c, schema.recordings
    told = select(said.thing_id).where(said.property == name, said.label == label)
    if not viewer.everything:
        heard = Tells(schema.audit.c.detail, "known", said.document)
        by_person = exists().where(schema.audit.c.thing_id == things.c.id, viewer.hears(), heard)
        told = told.join(things, things.c.id == said.thing_id).where(or_(by_person, viewer.sees_all()))
    found = union(
        told,
        select(entries.thing_id)
        .join(recordings, recordings.c.id == entries.recording_id)
        .where(entries.property == name, entries.label == label, recordings.c.ground_truth, viewer.of(recordings)),
    ).subquery()
    head = func.coalesce(things.c.merged_into, things.c.id)
    heads = select(head).where(things.c.id.in_(select(found.c.thing_id)))
    return select(things.c.id).where(head.in_(heads))
