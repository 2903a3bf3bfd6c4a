"""All pages, and the files that they need."""

from __future__ import annotations

from fastapi import FastAPI
from starlette.responses import Response
from starlette.staticfiles import StaticFiles
from starlette.types import Scope

from palpate.server.pages import (
    accounts,
    benchmarking,
    bundles,
    comparing,
    devices,
    editing,
    episodes,
    guides,
    home,
    live,
    objects,
    overlays,
    recordings,
    sessions,
    sharing,
    sign_on,
    typed,
    upload,
    waiting,
)
from palpate.server.pages.templates import STATIC

__all__ = ["install"]

PARTS = (
    bundles,
    benchmarking,
    overlays,
    home,
    editing,
    objects,
    recordings,
    devices,
    comparing,
    live,
    episodes,
    guides,
    sessions,
    accounts,
    sign_on,
    sharing,
    upload,
    waiting,
)


class Assets(StaticFiles):
    """Files whose addresses change with their content."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """A file, to be kept by the browser."""
        found = await super().get_response(path, scope)
        found.headers["Cache-Control"] = "public, max-age=31536000, immutable"
        return found


def install(app: FastAPI) -> None:
    """Add the pages to an application; they are none of its documented service."""
    for part in PARTS:
        app.include_router(part.router, include_in_schema=False)
    typed.install(app)
    app.mount("/static", Assets(directory=STATIC), name="static")
