"""The application: a store and settings become what a server runs."""

from __future__ import annotations

import asyncio
import gc
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager, suppress
from pathlib import Path
from typing import Any

from anyio.to_thread import current_default_thread_limiter
from fastapi import APIRouter, Depends, FastAPI
from starlette.middleware import Middleware

from palpate import __version__
from palpate.server import watching
from palpate.server.api import corrections, episodes, objects, recordings, results, series, setups, sharing, users
from palpate.server.document import Described
from palpate.server.heads import HeadAsGet
from palpate.server.pages import site
from palpate.server.problems import OLD_ADDRESSES, Problem, Unexpected, install
from palpate.server.repeated import check_once
from palpate.server.rest import addresses
from palpate.server.security.bodies import BodyLimits
from palpate.server.security.headers import SecurityHeaders
from palpate.server.security.hosts import KnownHosts
from palpate.server.security.places import Places
from palpate.server.security.rates import Rate, RateLimit
from palpate.server.security.request_heads import HeadLimit
from palpate.server.settings import Settings
from palpate.server.state import State
from palpate.server.unknown_parameters import check_known
from palpate.server.uploading.previews import Previews
from palpate.store.opening import open_store
from palpate.store.store import Store

__all__ = ["application", "from_environment"]

API = "/api/v1"
PARTS = (corrections, objects, recordings, series, results, setups, episodes, sharing, users)
PROBLEMS: dict[int | str, dict[str, Any]] = {
    status: {"model": Problem} for status in (400, 401, 403, 404, 422, 429, 503)
}
BURST_S = 20.0
"""An address may ask at once what it may ask in so many seconds."""
OF_ACCOUNT = 10
"""An account may ask by its tokens so many times as often as an address."""
THREADS = 12
"""More of them only wait for each other; for each there is a connection to the database."""
CACHE_BYTES = 8 << 20
"""What each of these keeps of an SQLite file, so that all together stay small."""
ABOUT = "Measurements of the physical properties of objects: what was measured, with what, and how sure it is."


def application(store: Store, settings: Settings | None = None) -> FastAPI:
    """Make the application of a store; it closes the store when it stops."""
    settings = settings or Settings()
    previews = Previews(None if settings.previews is None else Path(settings.previews))

    @asynccontextmanager
    async def open_until_stopped(_: FastAPI) -> AsyncIterator[None]:
        sweeping = asyncio.create_task(previews.watch())
        current_default_thread_limiter().total_tokens = THREADS
        yield
        sweeping.cancel()
        with suppress(asyncio.CancelledError):
            await sweeping
        previews.close()
        store.close()

    app = Described(
        title="Palpate",
        version=__version__,
        description=ABOUT,
        # pages that FastAPI has for it take their scripts from elsewhere
        docs_url=None,
        redoc_url=None,
        openapi_url=f"{API}/openapi.json",
        lifespan=open_until_stopped,
        dependencies=[Depends(check_once)],
        middleware=_middleware(settings),
    )
    app.state.palpate = State(store, settings, previews, settings.provider())
    install(app)
    app.include_router(watching.router)
    service = APIRouter(prefix=API, responses=PROBLEMS, dependencies=[Depends(check_known)])
    for part in PARTS:
        service.include_router(part.router)
    app.include_router(service)
    app.include_router(addresses.router, include_in_schema=False)
    site.install(app)
    return app


def from_environment() -> FastAPI:
    """The application that the environment describes: what each worker runs."""
    settings = Settings.from_environment()
    watching.start_log(requests=settings.log_requests)
    app = application(open_store(settings.place, settings.blobs, cache_bytes=CACHE_BYTES), settings)
    # what is loaded stays: looking through it for what could be thrown away took a sixth of each large upload
    gc.collect()
    gc.freeze()
    return app


def _middleware(settings: Settings) -> list[Middleware]:
    """From the outside to the inside."""

    def largest(method: str, path: str) -> int:
        all_recordings = f"{API}/recordings"
        uploads = (method == "POST" and path == all_recordings) or (
            method == "PUT" and path.startswith(f"{all_recordings}/")
        )
        uploads = uploads or (method == "POST" and (path == "/upload" or path.startswith(OLD_ADDRESSES)))
        return settings.largest_upload_bytes if uploads else settings.largest_body_bytes

    found = [
        Middleware(watching.Watching),
        Middleware(HeadAsGet),
        Middleware(SecurityHeaders, secure=settings.secure),
        Middleware(HeadLimit),
        Middleware(KnownHosts, hosts=settings.hosts),
    ]
    if settings.requests_per_s is not None:
        of_address, of_account = (_rate(times * settings.requests_per_s) for times in (1, OF_ACCOUNT))
        found.append(Middleware(RateLimit, of_address=of_address, of_account=of_account))
    return [*found, Middleware(Places), Middleware(Unexpected), Middleware(BodyLimits, largest=largest)]


def _rate(per_s: float) -> Rate:
    return Rate(per_s, round(BURST_S * per_s) or 1)
