"""Objects: lists, one of them, and its pictures."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Query, Request
from fastapi.responses import Response

from palpate.errors import plural
from palpate.server.api import plain
from palpate.server.api.answers import answer, page
from palpate.server.api.downloads import stored_download
from palpate.server.api.models import Object, Page
from palpate.server.api.parameters import Place, SeenThing, StoreOf
from palpate.server.api.queries import ObjectQuery
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store.visible_things import list_visible_things

__all__ = ["router"]

router = APIRouter(prefix="/objects", tags=["objects"])


@router.get("", response_model=Page[Object])
def list_objects(request: Request, store: StoreOf, who: Who, query: Annotated[ObjectQuery, Query()]) -> Response:
    """Objects by dataset and name; those merged into another one are part of it."""
    found = list_visible_things(store, who.viewer, query.filter(), limit=query.limit, cursor=query.cursor)
    return page(request, query, map(plain.thing, found.rows), found.cursor)


@router.get("/{dataset}/{name}", response_model=Object)
def get_object(thing: SeenThing) -> Response:
    """One object. In names a slash is ``~2f``, a tilde ``~7e`` and a dot in front ``~2e``."""
    return answer(plain.thing(thing))


@router.get("/{dataset}/{name}/images/{position}", response_class=Response)
def get_image(request: Request, thing: SeenThing, position: Place) -> Response:
    """A picture of it."""
    if position >= len(thing.images):
        raise problem(404, f"object {thing.path}: has {plural(len(thing.images), 'image')}, and none at {position}")
    image = thing.images[position]
    return stored_download(request, image.name, image.media_type, image.sha256)
