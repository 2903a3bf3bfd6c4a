"""What is seen and heard of an upload before it is kept: of that which waits, for who has sent it alone."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated

from fastapi import APIRouter, Depends, Request
from fastapi.responses import Response

from palpate.server.api.downloads import download
from palpate.server.api.parameters import DIGEST, Place
from palpate.server.api.series import get_sound
from palpate.server.memory import Memory
from palpate.server.pages.signals import kind_of
from palpate.server.problems import ProblemError, WayOn, problem
from palpate.server.security.accounts import Account, Role
from palpate.server.security.who import needs
from palpate.server.state import state_of
from palpate.server.uploading.fates import ALL
from palpate.server.uploading.preview import Preview, holder_of
from palpate.store.opening import open_store
from palpate.store.parts import Head, head_of
from palpate.store.store import Store
from palpate.store.stored_bytes import StoredBytes

__all__ = ["Owner", "Waiting", "gone", "router", "waiting_preview"]

router = APIRouter(prefix="/upload/{id}/recordings/{digest}")
Owner = Annotated[Account, Depends(needs(Role.OWNER))]


def waiting_preview(request: Request, who: Owner, id: str) -> Preview:
    """The upload of an id, where it waits and is theirs; else a 404."""
    found = state_of(request).previews.get(id, holder_of(request, who))
    if found is None:
        raise gone()
    return found


Waiting = Annotated[Preview, Depends(waiting_preview)]


def gone() -> ProblemError:
    """What is answered where nothing waits."""
    return problem(
        404,
        "there is no upload that waits here: it was kept or cancelled, its time is over, newer ones took its place,"
        " or it is not yours",
        way_on=WayOn("No upload waits here", "/upload", "Upload something"),
    )


@contextmanager
def _opened(waiting: Preview, digest: str) -> Iterator[tuple[Store, Head]]:
    with open_store(waiting.place, waiting.blobs, durable=False, make=False) as scratch:
        head = head_of(scratch, ALL, bytes.fromhex(digest)) if DIGEST.fullmatch(digest) else None
        if head is None:
            raise problem(404, f"recording {digest[:80]}: there is none in this upload")
        yield scratch, head


@router.get("/files/{place}")
def file(request: Request, waiting: Waiting, digest: str, place: Place) -> Response:
    """A picture or a sound; other files are not given out before they are kept."""
    with _opened(waiting, digest) as (scratch, head):
        item = head.files[place] if place < len(head.files) else None
        if item is None or kind_of(scratch, item) == "other":
            raise problem(404, f"recording {head.digest}: there is no picture or sound in file {place}")
        content = StoredBytes(scratch.blobs, item.sha256)
        return download(request, content, item.name, item.media_type, item.sha256)


@router.get("/series/{position}/channels/{channel}/sound")
def sound(request: Request, waiting: Waiting, memory: Memory, digest: str, position: Place, channel: Place) -> Response:
    """A channel that is a sound, as the API gives it when it is kept."""
    with _opened(waiting, digest) as (scratch, head):
        return get_sound(request, scratch, head, memory, position, channel)
