"""Which methods an address has."""

from __future__ import annotations

from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from starlette.types import Scope

__all__ = ["methods_of"]


def methods_of(app: FastAPI, scope: Scope) -> list[str]:
    """All methods of the address of a request: the framework tells those of the first route that fits.

    Examples
    --------
    >>> app = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)
    >>> here = app.get("/a")(lambda: 1), app.put("/{name}")(lambda name: 1)
    >>> methods_of(app, {"path": "/a", "type": "http", "method": "POST"})
    ['GET', 'HEAD', 'PUT']
    """
    found = set[str]()
    for route in iter_route_contexts(app.routes):
        pattern = getattr(route, "path_regex", None)
        if pattern is not None and pattern.match(scope["path"]):
            found |= set(getattr(route, "methods", None) or ())
    return sorted(found | {"HEAD"} if "GET" in found else found)
