"""BokehJS, from the installed package: its address changes with its content, so that browsers keep it."""

from __future__ import annotations

import gzip
from functools import lru_cache
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path

from fastapi import APIRouter, Request
from fastapi.responses import Response

__all__ = ["bokeh_address", "router"]

router = APIRouter()
PATH = "/bundles/bokeh.min.js"
KEPT = {"Cache-Control": "public, max-age=31536000, immutable", "Vary": "Accept-Encoding"}


@router.get(PATH)
def bokeh(request: Request) -> Response:
    """The one bundle that plots need."""
    if "gzip" in request.headers.get("accept-encoding", ""):
        return Response(_packed(), 200, {**KEPT, "Content-Encoding": "gzip"}, "text/javascript")
    return Response(_file().read_bytes(), 200, KEPT, "text/javascript")


@lru_cache(maxsize=1)
def bokeh_address() -> str:
    """Where pages find it."""
    return f"{PATH}?v={sha256(_file().read_bytes()).hexdigest()[:12]}"


@lru_cache(maxsize=1)
def _packed() -> bytes:
    # once for all requests, as it takes a tenth of a second
    return gzip.compress(_file().read_bytes(), 6, mtime=0)


def _file() -> Path:
    """Found without importing the package, which pages do not need."""
    spec = find_spec("bokeh")
    if spec is None or not spec.submodule_search_locations:
        raise ModuleNotFoundError("bokeh is not installed; it comes with palpate[server]")
    return Path(spec.submodule_search_locations[0]) / "server" / "static" / "js" / "bokeh.min.js"
