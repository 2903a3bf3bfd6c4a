"""Guides: how to record, upload, have an account, ask by program, and cite."""

from __future__ import annotations

import re

from fastapi import APIRouter, Request
from fastapi.responses import HTMLResponse
from markupsafe import Markup, escape

from palpate.server.pages.templates import page
from palpate.server.problems import problem
from palpate.server.security.who import Who

__all__ = ["router"]

router = APIRouter(prefix="/guides")
CODE = re.compile(r"(`+)(.+?)\1", re.DOTALL)
TITLES = {
    "record": "Record",
    "upload": "Upload",
    "accounts": "Accounts and tokens",
    "watch": "Watch an exploration",
    "api": "Ask by program",
    "cite": "Cite",
}


@router.get("")
def guides(request: Request, who: Who) -> HTMLResponse:
    """All guides."""
    return page(request, "guides.html", titles=TITLES)


@router.get("/{name}")
def guide(request: Request, who: Who, name: str) -> HTMLResponse:
    """One guide."""
    if name not in TITLES:
        raise problem(404, f"guide {name[:40]!r}: there is none of that name")
    operations = _operations(request.app.openapi()) if name == "api" else []
    root = str(request.base_url).rstrip("/")
    return page(request, f"guides/{name}.html", title=TITLES[name], root=root, operations=operations)


def _operations(document: dict[str, dict[str, dict[str, dict[str, str]]]]) -> list[tuple[str, str, Markup]]:
    """Method, path and what it is for, of each operation of the service."""
    return [
        (method.upper(), path, with_code(operation.get("description", operation.get("summary", ""))))
        for path, methods in document["paths"].items()
        for method, operation in methods.items()
        if path.startswith("/api/")
    ]


def with_code(text: str) -> Markup:
    """What stands between backticks as code.

    Examples
    --------
    >>> str(with_code("a slash is ``~2f``, <not> a `tilde`"))
    'a slash is <code>~2f</code>, &lt;not&gt; a <code>tilde</code>'
    """
    return Markup(CODE.sub(r"<code>\2</code>", str(escape(text))))
