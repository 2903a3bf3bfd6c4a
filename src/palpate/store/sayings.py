"""By which words somebody knows an object: conditions that depend on nothing that they do not see.

A word is known where a recording that is seen says it, whatever else is said of the object; where a person has said it
to who looks, and it still holds; and where all that was done with the object is seen. What is looked for must never be
compared with what is hidden unless it was seen whole: whoever sends recordings could guess it letter by letter.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

from sqlalchemy import Column, ColumnElement, exists, func, literal, or_

from palpate.store import schema
from palpate.store.content import to_json
from palpate.store.filters import called
from palpate.store.json_columns import Holds, HoldsText, JsonText, each_text

if TYPE_CHECKING:
    from palpate.store.viewing import Viewer

__all__ = ["is_seen", "knows_name", "knows_word"]

NAMED = ("common_name", "maker")


def knows_name(viewer: Viewer, name: str) -> ColumnElement[bool]:
    """The condition on `schema.things` that somebody knows one by a name: its own, its common one, or an alias."""
    if viewer.everything:
        return called(name)
    things, said, document = schema.things.c, schema.descriptions.c, literal(to_json(name))
    is_own = or_(things.name == name, things.dataset + "/" + things.name == name)
    described = _is_described(viewer, or_(said.common_name == name, HoldsText(said.aliases, name)))
    told = or_(
        (things.common_name == name) & _tells("common_name", document),
        HoldsText(things.aliases, name) & _tells_alias(document),
    )
    return or_(is_own, described, _hears(viewer, told), called(name) & viewer.sees_all())


def knows_word(viewer: Viewer, word: str) -> ColumnElement[bool]:
    """The condition on `schema.things` that somebody knows one by a part of a word, in any case."""
    things, said = schema.things.c, schema.descriptions.c
    is_own = or_(*(_has(things[name], word) for name in ("dataset", "name")))
    held = or_(*(_has(things[name], word) for name in (*NAMED, "aliases")))
    if viewer.everything:
        return or_(is_own, held)
    described = _is_described(viewer, said.words.contains(word.casefold(), autoescape=True))
    return or_(is_own, described, held & _hears(viewer, or_(*_told(word))), held & viewer.sees_all())


def is_seen(viewer: Viewer) -> ColumnElement[bool]:
    """The condition on `schema.descriptions` that a recording says it that somebody sees."""
    recordings = schema.recordings
    return exists().where(recordings.c.description_id == schema.descriptions.c.id, viewer.of(recordings))


def _is_described(viewer: Viewer, condition: ColumnElement[bool]) -> ColumnElement[bool]:
    """That a recording that is seen says of an object what a condition on `schema.descriptions` says."""
    return exists().where(schema.descriptions.c.thing_id == schema.things.c.id, condition, is_seen(viewer))


def _has(column: Column[str] | ColumnElement[str], word: str) -> ColumnElement[bool]:
    return func.lower(column).contains(word.lower(), autoescape=True)


def _hears(viewer: Viewer, told: ColumnElement[bool]) -> ColumnElement[bool]:
    """That a person has told somebody of an object what a condition on `schema.audit` says."""
    return exists().where(schema.audit.c.thing_id == schema.things.c.id, told, viewer.hears())


def _told(word: str) -> Iterator[ColumnElement[bool]]:
    """Conditions on `schema.audit` that a line tells something of which a word is a part, and that still holds."""
    things, alias = schema.things.c, each_text(schema.things.c.aliases)
    for name in NAMED:
        yield _has(things[name], word) & _tells(name, JsonText(things[name]))
    yield exists().select_from(alias).where(_has(alias.c.value, word), _tells_alias(JsonText(alias.c.value)))


def _tells(field: str, document: ColumnElement[str]) -> ColumnElement[bool]:
    """That a line gives a field this text, in place of another or of none: keys are in the order of the alphabet."""
    audit, end = schema.audit.c, f',"field":["{field}"]}}'
    alone = Holds(audit.detail, literal('{"after":') + document + literal(end))
    replacing = Holds(audit.detail, literal('{"after":') + document + literal(',"before":'))
    return or_(alone, replacing & Holds(audit.detail, literal(end)))


def _tells_alias(document: ColumnElement[str]) -> ColumnElement[bool]:
    said = literal('{"after":') + document + literal(',"field":["aliases",') + document + literal("]}")
    return Holds(schema.audit.c.detail, said)
