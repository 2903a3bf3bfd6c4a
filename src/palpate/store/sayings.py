"""By which words somebody knows an object: conditions that depend on nothing that they do not see.

Where all that was done with an object is seen, it is known by its description. Else by what is shown of it, see
`palpate.store.told_words`: what recordings that are seen say, and persons to who looks. What is looked for must never
be compared with what is hidden: whoever sends recordings could guess it letter by letter.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlalchemy import Column, ColumnElement, and_, case, exists, func, literal, not_, or_, select

from palpate.store import schema
from palpate.store.any_case import Small
from palpate.store.content import to_json
from palpate.store.filters import called
from palpate.store.json_columns import Holds, HoldsText, Tells

if TYPE_CHECKING:
    from palpate.store.viewing import Viewer

__all__ = ["is_seen", "knows_name", "may_know_word"]

COMMON_NAME = '"field":["common_name"]}'


def knows_name(viewer: Viewer, name: str) -> ColumnElement[bool]:
    """The condition on `schema.things` that somebody knows one by a name: its own, its common one, or an alias."""
    if viewer.everything:
        return called(name)
    things = schema.things.c
    is_own = or_(things.name == name, things.dataset + "/" + things.name == name)
    whole = called(name) & viewer.sees_all()
    return or_(is_own, whole, and_(or_(_describes(viewer, name), _tells(viewer, name)), not_(viewer.sees_all())))


def may_know_word(viewer: Viewer, word: str) -> ColumnElement[bool]:
    """The condition on `schema.things` that somebody may know one by a part of a word, in any case.

    Where it does not hold they do not. Where it does something that they see says the word, and may hold no more.
    """
    things, said = schema.things.c, schema.descriptions.c
    is_own = or_(*(_has(things[name], word) for name in ("dataset", "name")))
    held = or_(*(_has(things[name], word) for name in ("common_name", "maker", "aliases")))
    if viewer.everything:
        return or_(is_own, held)
    described = _is_described(viewer, said.words.contains(word.casefold(), autoescape=True))
    told = _hears(viewer, _has(schema.audit.c.detail, to_json(word)[1:-1]))
    return or_(is_own, described, told, held & viewer.sees_all())


def is_seen(viewer: Viewer) -> ColumnElement[bool]:
    """The condition on `schema.descriptions` that a recording says it that somebody sees."""
    recordings = schema.recordings
    return exists().where(recordings.c.description_id == schema.descriptions.c.id, viewer.of(recordings))


def _is_described(viewer: Viewer, condition: ColumnElement[bool]) -> ColumnElement[bool]:
    """That a recording that is seen says of an object what a condition on `schema.descriptions` says."""
    return exists().where(schema.descriptions.c.thing_id == schema.things.c.id, condition, is_seen(viewer))


def _has(column: Column[str] | ColumnElement[str], word: str) -> ColumnElement[bool]:
    return Small(column).contains(word.lower(), autoescape=True)


def _hears(viewer: Viewer, told: ColumnElement[bool]) -> ColumnElement[bool]:
    """That a person has told somebody of an object what a condition on `schema.audit` says."""
    return exists().where(schema.audit.c.thing_id == schema.things.c.id, told, viewer.hears())


def _describes(viewer: Viewer, name: str) -> ColumnElement[bool]:
    """That a recording that is seen calls an object so, and nobody who is heard has replaced or taken that away."""
    said = schema.descriptions.c
    by_common = (said.common_name == name) & not_(_hears(viewer, _replaces(viewer, name)))
    described = _is_described(viewer, or_(HoldsText(said.aliases, name), by_common))
    alias = _about_alias(name)
    return and_(described, not_(_last_heard(viewer, alias, not_(_gives("aliases", name)))))


def _tells(viewer: Viewer, name: str) -> ColumnElement[bool]:
    """That the last who was heard to say what an object is called has called it so."""
    about = Holds(schema.audit.c.detail, literal(COMMON_NAME))
    common = _last_heard(viewer, about, _gives("common_name", name))
    return or_(common, _last_heard(viewer, _about_alias(name), _gives("aliases", name)))


def _last_heard(viewer: Viewer, about: ColumnElement[bool], condition: ColumnElement[bool]) -> ColumnElement[bool]:
    """That a condition on `schema.audit` holds for the last of the lines that are heard and about something."""
    line = schema.audit.c
    holds = select(case((condition, 1), else_=0)).where(line.thing_id == schema.things.c.id, about, viewer.hears())
    last = holds.order_by(line.id.desc()).limit(1).correlate(schema.things)
    return func.coalesce(last.scalar_subquery(), 0) == 1


def _replaces(viewer: Viewer, name: str) -> ColumnElement[bool]:
    """The condition on `schema.audit` that a line says something else than the common name that was shown by then."""
    line, said, recordings = schema.audit.c, schema.descriptions, schema.recordings
    came = select(said.c.common_name).join(recordings, recordings.c.description_id == said.c.id)
    came = came.where(said.c.thing_id == line.thing_id, said.c.common_name.is_not(None))
    came = came.where(recordings.c.uploaded_us <= line.at_us, viewer.of(recordings))
    first = came.order_by(recordings.c.id).limit(1).correlate(schema.audit)
    return Holds(line.detail, literal(COMMON_NAME)) & (first.scalar_subquery() == name)


def _about_alias(name: str) -> ColumnElement[bool]:
    return Holds(schema.audit.c.detail, literal(f'"field":["aliases",{to_json(name)}]}}'))


def _gives(kind: str, name: str) -> ColumnElement[bool]:
    """The condition on `schema.audit` that a line gives a field of this kind a name."""
    return Tells(schema.audit.c.detail, kind, literal(to_json(name)))
