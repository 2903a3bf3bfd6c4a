"""Where somebody comes back to who had to log in first: a page of this site, and no other."""

from __future__ import annotations

import re
from urllib.parse import quote, urlsplit

from fastapi import Request

__all__ = ["log_in_for", "own_path", "way_in"]

OWN = re.compile(r"/(?![/\\])[!-\[\]-~]*")
LONGEST = 2000
LOG_IN = "/login"


def own_path(text: str) -> str:
    """The path of a page of this site as it was given; the first page in place of anything else.

    Two slashes, and a backslash, which browsers take for one, begin the name of another computer.

    Examples
    --------
    >>> own_path("/upload?device=a"), own_path("//evil.example/"), own_path("https://evil.example/")
    ('/upload?device=a', '/', '/')
    """
    is_own = len(text) <= LONGEST and OWN.fullmatch(text) and not text.startswith(LOG_IN)
    return text if is_own else "/"


def way_in(request: Request) -> str:
    """The address to log in at, and to come back from to the page that was asked for; of a form to its page."""
    if request.method not in ("GET", "HEAD"):
        return log_in_for(_page_of_form(request))
    query = quote(request.url.query, safe="/?&=%+,:;@!$'()*~-._")
    return log_in_for(own_path(quote(request.scope["path"]) + (f"?{query}" if query else "")))


def _page_of_form(request: Request) -> str:
    """The page of this site that a browser says it comes from."""
    came = urlsplit(request.headers.get("referer", ""))
    if came.netloc != request.headers.get("host"):
        return "/"
    return own_path(came.path + (f"?{came.query}" if came.query else ""))


def log_in_for(path: str, log_in: str = LOG_IN) -> str:
    """The address to log in at, and to come back from to a page of this site.

    Examples
    --------
    >>> log_in_for("/upload?device=a"), log_in_for("/")
    ('/login?next=/upload%3Fdevice%3Da', '/login')
    """
    return log_in if path == "/" else f"{log_in}?next={quote(path, safe='/')}"
