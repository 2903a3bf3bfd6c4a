"""Changing what is said of an object, merging, splitting and taking back; and who did it."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query
from fastapi.responses import Response
from pydantic import Field

from palpate.server.api import models, plain
from palpate.server.api.answers import answer
from palpate.server.api.parameters import SeenThing, StoreOf, seen_thing
from palpate.server.api.queries import Text
from palpate.server.corrections import Corrections
from palpate.server.problems import problem
from palpate.server.security.accounts import Account, Role
from palpate.server.security.who import needs
from palpate.store.decoding import entry_from
from palpate.store.entries import Entry

__all__ = ["router"]

router = APIRouter(prefix="/objects/{dataset}/{name}", tags=["objects"])
Named = Annotated[Text, Field(min_length=1)]
Owner = Annotated[Account, Depends(needs(Role.OWNER))]


def _corrections(store: StoreOf, who: Owner, thing: SeenThing) -> Corrections:
    return Corrections(store, who, thing)


Of = Annotated[Corrections, Depends(_corrections)]


class Description(models.Strict):
    """Other words; what is left out stays."""

    common_name: Text | None = None
    maker: Text | None = None
    aliases: list[Text] = Field([], max_length=50)
    attributes: dict[str, Any] = Field({}, max_length=200)


class Forgotten(models.Strict):
    """What a source, or any, says of a property; a name that is mistyped must not make it any."""

    property: Text
    source: Text | None = None


class Into(models.Strict):
    """The object that another one counts as from now on; and whether others may learn its name by that."""

    dataset: Named
    name: Named
    shows_name: bool = False


@router.patch("", response_model=models.Object)
def describe(corrections: Of, described: Description) -> Response:
    """Describe it otherwise; what is left out stays, what is null is removed."""
    fields = described.model_dump(include=described.model_fields_set)
    if "aliases" in fields:
        fields["aliases"] = tuple(fields["aliases"])
    corrections.describe(fields)
    return _now(corrections)


@router.put("/known", response_model=models.Object)
def know(corrections: Of, known: models.Known) -> Response:
    """Tell what a source says of a property, in place of what it said before."""
    corrections.know(_entry(known.entry), known.source)
    return _now(corrections)


@router.delete("/known", response_model=models.Object)
def forget(corrections: Of, asked: Annotated[Forgotten, Query()]) -> Response:
    """Tell no longer what a source, or any source, says of a property."""
    corrections.forget(asked.property, asked.source)
    return _now(corrections)


@router.post("/merge", response_model=models.Object)
def merge(corrections: Of, into: Into) -> Response:
    """Let it count as another one, which is the answer: no recording is changed.

    Who sees the first learns the name of the second: where that is new to others, it is done only with `shows_name`.
    """
    ref = corrections.merge(into.dataset, into.name, shows_name=into.shows_name)
    return answer(plain.thing(seen_thing(corrections.store, corrections.who, ref.dataset, ref.id)))


@router.post("/split", response_model=models.Object)
def split(corrections: Of) -> Response:
    """Let it count as one of its own again."""
    corrections.split()
    return _now(corrections)


@router.post("/undo", response_model=models.Object)
def undo(corrections: Of) -> Response:
    """Take back the last change that holds; again, the one before."""
    corrections.undo()
    return _now(corrections)


@router.get("/history", response_model=models.Page[models.Change])
def history(corrections: Of) -> Response:
    """Who changed what, the last first; for those who may change it."""
    items = [
        {
            "at": plain.moment(one.at),
            "who": one.who,
            "what": one.what,
            "detail": one.detail,
            "undone_at": plain.moment(one.undone_at),
            "undone_by": one.undone_by,
        }
        for one in corrections.history()
    ]
    return answer({"items": items, "next": None})


def _now(corrections: Corrections) -> Response:
    ref = corrections.thing.ref
    return answer(plain.thing(seen_thing(corrections.store, corrections.who, ref.dataset, ref.id)))


def _entry(given: models.Entry) -> Entry:
    try:
        return entry_from(given.model_dump(exclude_unset=True))
    except TypeError as error:
        told = f"entry: fields do not fit its kind ({error})"
        raise problem(422, told, [{"field": "body.entry", "detail": told}]) from None
