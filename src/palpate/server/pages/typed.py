"""What was typed into a form by somebody whose session had ended: it is kept until they have logged in again."""

from __future__ import annotations

import json
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.responses import HTMLResponse
from starlette.responses import Response

from palpate.server.pages.templates import page
from palpate.server.problems import ProblemError, answer_http, is_page
from palpate.server.security.returns import own_path
from palpate.server.security.sites import form_of

__all__ = ["Typed", "install", "send_again_page"]


class Typed:
    """A form that was not taken: the address that it goes to, and its fields.

    Between two pages it is a hidden field of the form to log in by, as JSON, so that its fields are none of that form.
    """

    def __init__(self, to: str, fields: Mapping[str, str]) -> None:
        self.to, self.fields = to, fields

    def __str__(self) -> str:
        return json.dumps([self.to, dict(self.fields)])

    @classmethod
    def parse(cls, text: str) -> Typed | None:
        """What `str` gave; None where somebody else has written it."""
        try:
            to, fields = json.loads(text)
            found = cls(own_path(to), {str(name): str(value) for name, value in fields.items()})
        except (ValueError, TypeError, AttributeError, RecursionError):
            return None
        return None if found.to == "/" else found


def install(app: FastAPI) -> None:
    """Let an application keep what was typed where it asks to log in first."""
    app.add_exception_handler(HTTPStatus.UNAUTHORIZED, _answer)


async def _answer(request: Request, error: Any) -> Response:
    # imported here, as the form to log in by keeps what is typed too
    from palpate.server.pages.sessions import log_in_form

    typed = await _typed(request) if request.method == "POST" and is_page(request) else None
    return await answer_http(request, error) if typed is None else log_in_form(request, 401, typed=typed)


async def _typed(request: Request) -> Typed | None:
    try:
        return Typed(request.url.path, await form_of(request))
    except ProblemError:
        # files are not sent back and forth, nor what a page of another site has sent
        return None


def send_again_page(request: Request, typed: Typed) -> HTMLResponse:
    """What was typed, to be sent by whoever is logged in now."""
    return page(request, "again.html", typed=typed)
