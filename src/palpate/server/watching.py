"""What a server tells about itself: whether it is well, how much it is asked, and a line for each request."""

from __future__ import annotations

import json
import logging
import re
import sys
import time

from fastapi import APIRouter, Request
from fastapi.responses import JSONResponse, Response
from prometheus_client import CONTENT_TYPE_LATEST, REGISTRY, CollectorRegistry, Counter, Histogram, generate_latest
from prometheus_client.multiprocess import MultiProcessCollector
from sqlalchemy import text
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.server.api.parameters import StoreOf
from palpate.server.problems import Problem, problem
from palpate.server.security.accounts import Role
from palpate.server.security.addresses import is_here
from palpate.server.security.who import Who
from palpate.server.sending import Sending
from palpate.server.state import state_of
from palpate.store.database import asking

__all__ = ["Watching", "router", "start_log"]

_log = logging.getLogger("palpate.server.requests")
router = APIRouter(tags=["health"])
BUCKETS = (0.005, 0.01, 0.025, 0.05, 0.1, 0.25, 0.5, 1.0, 2.5, 5.0, 10.0)
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f]")
REQUESTS = Counter("palpate_requests", "Requests answered", ("method", "route", "status"))
SECONDS = Histogram("palpate_request_seconds", "Time to the last byte", ("method", "route"), buckets=BUCKETS)


@router.get("/health")
def health(store: StoreOf) -> Response:
    """Whether the store answers: 200, or 503."""
    with asking(store.engine) as connection:
        connection.execute(text("SELECT 1 FROM recordings LIMIT 1"))
    return JSONResponse({"status": "ok"})


@router.get("/metrics", response_class=Response, responses={401: {"model": Problem}})
def metrics(request: Request, who: Who) -> Response:
    """Counts and times for Prometheus, of all workers: to this computer, and to whoever has a token."""
    proxied = state_of(request).settings.proxied
    if who.role is Role.NOBODY and not is_here(request, proxied=proxied):
        raise problem(401, "metrics are for this computer, or need a token", headers={"WWW-Authenticate": "Bearer"})
    return Response(generate_latest(_registry()), media_type=CONTENT_TYPE_LATEST)


def _registry() -> CollectorRegistry:
    import os

    if "PROMETHEUS_MULTIPROC_DIR" not in os.environ:
        return REGISTRY
    registry = CollectorRegistry()
    MultiProcessCollector(registry)  # type: ignore[no-untyped-call]
    return registry


def start_log(*, requests: bool) -> None:
    """Write what goes wrong to standard error, and each request where that is wanted."""
    written = logging.StreamHandler(sys.stderr)
    written.setFormatter(_Legible("%(message)s"))
    logging.basicConfig(handlers=[written])
    _log.setLevel(logging.INFO if requests else logging.WARNING)


class _Legible(logging.Formatter):
    """Writes what a terminal would take for a command as its number; the lines of an error stay lines."""

    def format(self, record: logging.LogRecord) -> str:
        return CONTROL.sub(lambda found: f"\\x{ord(found[0]):02x}", super().format(record))


class Watching:
    """Counts each request, times it, and logs it as a line of JSON; nothing of what was asked but the path."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        started, sending = time.perf_counter(), Sending(send)
        try:
            await self.app(scope, receive, sending)
        finally:
            _note(scope, sending.status or 500, time.perf_counter() - started)


def _note(scope: Scope, status: int, seconds: float) -> None:
    route = getattr(scope.get("route"), "path", "none")
    # any text may stand where a method does
    method = scope["method"] if scope["method"] in METHODS else "other"
    REQUESTS.labels(method, route, str(status)).inc()
    SECONDS.labels(method, route).observe(seconds)
    told = {"method": method, "path": scope["path"], "status": status, "ms": round(1e3 * seconds, 1)}
    client = scope.get("client")
    _log.info(json.dumps({**told, "client": client[0] if client else None}))


METHODS = ("GET", "HEAD", "PUT", "POST", "DELETE", "OPTIONS", "PATCH")
