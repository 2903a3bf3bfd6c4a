"""Errors in one form: problem details (RFC 9457), for programs as JSON and for people as a page."""

from __future__ import annotations

import json
import logging
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from http import HTTPStatus
from typing import Any
from urllib.parse import quote

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse, PlainTextResponse
from pydantic import BaseModel
from sqlalchemy.exc import DataError, OperationalError
from sqlalchemy.exc import TimeoutError as NoConnectionError
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect
from starlette.responses import Response
from starlette.types import ASGIApp, Receive, Scope, Send

from palpate.errors import PalpateError
from palpate.server.methods import methods_of
from palpate.server.pages.templates import error_page
from palpate.server.sending import Sending
from palpate.store.errors import DamagedError, StoreError, UnavailableError

__all__ = [
    "MEDIA_TYPE",
    "OLD_ADDRESSES",
    "Problem",
    "ProblemError",
    "Unexpected",
    "WayOn",
    "answer_http",
    "install",
    "is_page",
    "problem",
    "problem_of_store",
    "problem_response",
]

_log = logging.getLogger("palpate.server")
FIELD = re.compile(r"([A-Za-z_][\w-]*(?:\[\d+\])?(?:\.[A-Za-z_][\w-]*(?:\[\d+\])?)*): (.*)", re.DOTALL)
MEDIA_TYPE = "application/problem+json"
OLD_ADDRESSES = "/rest/"


class Field(BaseModel):
    """A part of a request that is wrong."""

    field: str
    detail: str


class Problem(BaseModel):
    """What went wrong: a title for its kind, one sentence for this case, and the fields where it is about some."""

    type: str = "about:blank"
    title: str
    status: int
    detail: str
    errors: list[Field] = []


@dataclass(frozen=True)
class WayOn:
    """How the page of a problem is headed, and where it leads: an address, and the words of the link."""

    heading: str
    address: str
    words: str


class ProblemError(HTTPException):
    """A problem that ends a request; people may be told how to go on from there."""

    def __init__(self, found: Problem, headers: Mapping[str, str] | None = None, way_on: WayOn | None = None) -> None:
        super().__init__(found.status, found.detail, headers)
        self.problem = found
        self.way_on = way_on


def problem(
    status: int,
    detail: str,
    errors: Sequence[Mapping[str, str]] = (),
    headers: Mapping[str, str] | None = None,
    way_on: WayOn | None = None,
) -> ProblemError:
    """An error to raise."""
    fields = [Field(**one) for one in errors]
    found = Problem(title=HTTPStatus(status).phrase, status=status, detail=detail, errors=fields)
    return ProblemError(found, headers, way_on)


def problem_of_store(error: PalpateError, status: int = 422) -> ProblemError:
    """The error of a store, which names the field first where it is about one."""
    said = " ".join(str(error).split())
    field = FIELD.fullmatch(said)
    return problem(status, said, [{"field": field[1], "detail": field[2]}] if field else [])


def install(app: FastAPI) -> None:
    """Let an application answer every error in this form."""
    app.add_exception_handler(HTTPException, answer_http)
    app.add_exception_handler(RequestValidationError, _invalid)
    app.add_exception_handler(UnavailableError, _unavailable)
    app.add_exception_handler(OperationalError, _unavailable)
    app.add_exception_handler(NoConnectionError, _unavailable)
    app.add_exception_handler(DamagedError, _damaged)
    app.add_exception_handler(StoreError, _store)
    app.add_exception_handler(ClientDisconnect, _gone)
    app.add_exception_handler(OverflowError, _out_of_range)
    app.add_exception_handler(DataError, _out_of_range)


def _answer(request: Request, error: HTTPException) -> Response:
    if isinstance(error, ProblemError):
        found = error.problem
    else:
        status = error.status_code
        found = Problem(title=HTTPStatus(status).phrase, status=status, detail=error.detail)
    headers = dict(error.headers or {})
    if is_page(request):
        way_on = error.way_on if isinstance(error, ProblemError) else None
        return error_page(request, found.status, found.title, found.detail, headers, way_on)
    return problem_response(found, headers)


def problem_response(found: Problem, headers: Mapping[str, str]) -> JSONResponse:
    """A problem as the answer to a program."""
    return _Told(found.model_dump(), found.status, headers, MEDIA_TYPE)


class _Told(JSONResponse):
    """A problem as JSON; as a sentence at the old program's addresses, whose uploader takes any JSON for a success."""

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        if not scope["path"].startswith(OLD_ADDRESSES):
            await super().__call__(scope, receive, send)
            return
        headers = {name: value for name, value in self.headers.items() if not name.startswith("content-")}
        told = json.loads(bytes(self.body))["detail"]
        await PlainTextResponse(f"{told}\n", self.status_code, headers)(scope, receive, send)


def is_page(request: Request) -> bool:
    """Whether it is a person with a browser who asks."""
    return not request.url.path.startswith("/api/") and "text/html" in request.headers.get("accept", "")


async def answer_http(request: Request, error: Any) -> Response:
    """Answer an error that has a status: for people as a page, for programs as a problem."""
    if error.status_code == HTTPStatus.METHOD_NOT_ALLOWED:
        error.headers = {**(error.headers or {}), "Allow": ", ".join(methods_of(request.app, request.scope))}
    return _answer(request, error)


async def _invalid(request: Request, error: Any) -> Response:
    errors = [{"field": _path(one["loc"]), "detail": _said(one)} for one in error.errors()]
    if is_page(request):
        # who reads a page asks by its address or a form, and needs not know how the server takes that apart
        errors = [{**one, "field": one["field"].partition(".")[2] or one["field"]} for one in errors]
    told = "; ".join(f"{one['field']}: {one['detail']}" for one in errors[:3])
    return _answer(request, problem(422, told, errors))


def _said(error: Mapping[str, Any]) -> str:
    # which class of Python's errors it was is nothing to who asks
    said = str(error["msg"]).removeprefix("Value error, ")
    return "is not known here, leave it out" if error["type"] == "extra_forbidden" else said


def _path(places: Sequence[str | int]) -> str:
    """Where in a request: ``query.limit``, ``body.entries[0].unit``."""
    return "".join(f"[{part}]" if isinstance(part, int) else f".{part}" for part in places).lstrip(".")


async def _store(request: Request, error: Any) -> Response:
    return _answer(request, problem_of_store(error))


async def _unavailable(request: Request, error: Any) -> Response:
    # the address of the database is nobody's business
    _log.error("the store cannot be used: %s", error)
    told = "the store cannot be used now; what was asked was not done"
    return _answer(request, problem(503, told, headers={"Retry-After": "5"}))


async def _damaged(request: Request, error: Any) -> Response:
    _log.error("damaged: %s", error)
    return _answer(request, problem(500, "stored bytes are damaged; `palpate store verify` tells which"))


async def _gone(request: Request, error: Any) -> Response:
    # nobody reads it but whoever looks at the log of requests
    return _answer(request, problem(400, "the body ended early"))


async def _out_of_range(request: Request, error: Any) -> Response:
    return _answer(request, problem(422, "a number or a text is none that the store can look for"))


class Unexpected:
    """Answers where nobody has foreseen an error, which goes to the log and not to whoever asked."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request."""
        if scope["type"] != "http":
            await self.app(scope, receive, send)
            return
        sending = Sending(send)
        try:
            await self.app(scope, receive, sending)
        except Exception:
            # what is no letter is written as in an address, so that nobody writes lines of their own into the log
            _log.exception("an error of the server: %s %s", scope["method"], quote(scope["path"]))
            if sending.status is not None:
                raise
            found = problem(500, "an error of the server, which is in its log")
            await _answer(Request(scope), found)(scope, receive, send)
