"""Requests that change something from a browser: they must come from a page of this site."""

from __future__ import annotations

from urllib.parse import parse_qsl, urlsplit

from fastapi import Request

from palpate.server.problems import problem

__all__ = ["check_same_site", "form_of"]

MOST_FIELDS = 100
FORM = "application/x-www-form-urlencoded"


def check_same_site(request: Request) -> None:
    """Refuse what a page of somebody else has sent, or a browser that does not say from where it comes."""
    origin = request.headers.get("origin")
    if origin is None or urlsplit(origin).netloc != request.headers.get("host"):
        raise problem(403, "origin: this was sent from another site")


async def form_of(request: Request) -> dict[str, str]:
    """The fields of a form on a page of this site; of several of one name the last."""
    check_same_site(request)
    if request.headers.get("content-type", "").partition(";")[0].strip().lower() != FORM:
        raise problem(415, f"content-type: expected {FORM}")
    body = await request.body()
    try:
        pairs = parse_qsl(body.decode("ascii"), keep_blank_values=True, max_num_fields=MOST_FIELDS)
    except ValueError:
        raise problem(422, "body: is no form, or has too many fields") from None
    if any("\0" in text for pair in pairs for text in pair):
        raise problem(422, "body: holds a zero byte, expected text")
    return dict(pairs)
