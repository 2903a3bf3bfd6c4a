"""Watching an exploration while it runs: a stream that tells of each step as soon as the store has it.

The explorer writes into the store and knows nothing of those who watch. A stream ends after a while by itself, and the
browser asks again with the last event it has had: so a server that is told to stop need not wait for watchers.
"""

from __future__ import annotations

import asyncio
import json
import time
from collections.abc import AsyncIterator
from uuid import UUID

from fastapi import APIRouter, Request
from fastapi.concurrency import run_in_threadpool
from fastapi.responses import Response, StreamingResponse

from palpate.server.api.parameters import StoreOf
from palpate.server.problems import problem
from palpate.server.security.who import Who
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_episodes import Progress, progress_of

__all__ = ["router"]

router = APIRouter(prefix="/episodes")
PAUSE_S = 0.5
LONGEST_S = 15.0
AGAIN_MS = 500
"""After how long a browser asks again."""


@router.get("/{id}/events")
async def events(request: Request, store: StoreOf, who: Who, id: UUID) -> Response:
    """Server-sent events: how far an exploration is, at once and after each step.

    The id of an event is the number of lines that the log has. 204, which ends a browser's asking, where it has had
    the last one.
    """
    known = _known(request)
    now = await run_in_threadpool(progress_of, store, who.viewer, id)
    if now is None:
        raise problem(404, f"episode {id}: there is none, or none that you may see")
    if now.stop is not None and known == now.lines:
        return Response(status_code=204)
    stream = _stream(store, who.viewer, id, known)
    # a proxy that gathers answers would hold events back
    headers = {"X-Accel-Buffering": "no", "Cache-Control": "no-store"}
    return StreamingResponse(stream, headers=headers, media_type="text/event-stream")


def _known(request: Request) -> int:
    """What a browser has had, or the page that it shows."""
    told = request.headers.get("last-event-id") or request.query_params.get("after") or ""
    return int(told) if told.isascii() and told.isdigit() and len(told) < 10 else -1


async def _stream(store: Store, viewer: Viewer, id: UUID, known: int) -> AsyncIterator[str]:
    end_s = time.monotonic() + LONGEST_S
    yield f"retry: {AGAIN_MS}\n\n"
    while time.monotonic() < end_s:
        now = await run_in_threadpool(progress_of, store, viewer, id)
        if now is None:
            return
        if now.lines != known:
            known = now.lines
            yield _event(now)
        if now.stop is not None:
            return
        await asyncio.sleep(PAUSE_S)


def _event(now: Progress) -> str:
    return f"id: {now.lines}\ndata: {json.dumps({'lines': now.lines, 'stop': now.stop})}\n\n"
