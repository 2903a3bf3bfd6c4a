"""Templates: how pages are made from values, and how values read in them."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from functools import lru_cache, partial
from hashlib import sha256
from pathlib import Path
from secrets import token_urlsafe
from typing import Any
from urllib.parse import urlencode

from fastapi import Request
from fastapi.responses import HTMLResponse
from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape
from starlette.datastructures import QueryParams

from palpate import __version__
from palpate.invisible import shown
from palpate.server.names import thing_address
from palpate.server.pages.bundles import bokeh_address
from palpate.server.pages.changes import change_text
from palpate.server.plots.drawing import number, with_sd
from palpate.server.security.accounts import Account, Role
from palpate.server.security.headers import policy
from palpate.server.security.returns import way_in
from palpate.store.entries import Bound, Distribution, Entry, Interval, Value
from palpate.store.records import ThingRef

__all__ = ["STATIC", "error_page", "page", "search", "with_query"]

STATIC = Path(__file__).parents[1] / "static"


def page(
    request: Request, template: str, status: int = 200, headers: Mapping[str, str] | None = None, **values: Any
) -> HTMLResponse:
    """A page from a template; ``path``, ``query`` and ``account`` tell each what was asked, and by whom."""
    account = getattr(request.state, "account", Account())
    nonce = token_urlsafe(16)
    told = {"path": request.url.path, "query": request.query_params, "account": account, "nonce": nonce}
    told |= {"may_upload": account.role >= Role.OWNER, "way_in": way_in(request)}
    body = _environment().get_template(template).render({**told, **values})
    return HTMLResponse(body, status, {"Content-Security-Policy": policy(nonce), **(headers or {})})


def error_page(
    request: Request, status: int, title: str, detail: str, headers: Mapping[str, str], way_on: object = None
) -> HTMLResponse:
    """The page of an error; to who is not logged in what is private looks as if it were not there.

    `way_on` has a heading instead of the title, and an address with the words of the link there.
    """
    may_be_private = status == 404 and getattr(request.state, "account", Account()).name is None
    log_in = way_in(request) if status == 401 or may_be_private else None
    told = {"code": status, "title": title, "detail": detail, "log_in": log_in, "way_on": way_on}
    return page(request, "error.html", status, headers, **told)


@lru_cache(maxsize=1)
def _environment() -> Environment:
    found = Environment(
        loader=PackageLoader("palpate.server"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        finalize=_finalized,
    )
    found.filters |= {"number": number, "day": _day, "moment": _moment, "entry": entry_text, "plural": _plural}
    found.filters["change"] = partial(change_text, entry_text=entry_text)
    found.filters |= {"grasp": grasp_text, "maybe": _maybe, "exact": _exact}
    found.globals |= {"thing_url": _thing_url, "asset": _asset, "version": __version__, "with_query": with_query}
    found.globals |= {"search": search, "bokeh_address": bokeh_address, "now": _now}
    return found


def _finalized(value: Any) -> Any:
    """What a page shows of a value: letters that nobody sees, and that turn what stands around them, as escapes."""
    return shown(value) if isinstance(value, str) and not hasattr(value, "__html__") else value


def _exact(value: object) -> Markup:
    """A text as it is, for what a form sends back."""
    return escape(value)


def entry_text(entry: Entry) -> str:
    """A result as people read it.

    Examples
    --------
    >>> entry_text(Value("mass", 118.0, 2.0, "g")), entry_text(Bound("elasticity", above=95.0, unit="kPa"))
    ('118 ± 2 g', 'above 95 kPa')
    """
    if isinstance(entry, Value):
        return f"{with_sd(entry.value, entry.sd)} {_unit(entry.unit)}"
    if isinstance(entry, Distribution):
        best = sorted(entry.probabilities.items(), key=lambda item: (-item[1], item[0]))
        return ", ".join(f"{label} {share:.0%}" for label, share in best[:3] if share >= 0.005)
    if isinstance(entry, Interval):
        return f"{number(entry.low)} to {number(entry.high)} {_unit(entry.unit)}"
    if isinstance(entry, Bound):
        side, value = ("above", entry.above) if entry.above is not None else ("below", entry.below)
        return f"{side} {number(value or 0.0)} {_unit(entry.unit)}"
    return f"failed: {entry.reason}"


def grasp_text(grasp: Mapping[str, Any]) -> str:
    """How an object was held, or could be, as people read it: in the words in which it was given.

    Examples
    --------
    >>> grasp_text({"proposed": True, "translation": [0.1, 0, 0.25], "gripper": "robotiq_2f85"})
    'proposed; translation 0.1, 0, 0.25; gripper robotiq_2f85'
    """
    return "; ".join(_grasp_part(name, value) for name, value in grasp.items() if value not in (None, False))


def _grasp_part(name: str, value: Any) -> str:
    told = name.replace("_", " ")
    if value is True:
        return told
    if isinstance(value, list):
        value = ", ".join(str(one) for one in value)
    if isinstance(value, Mapping):
        value = ", ".join(f"{key} {one}" for key, one in value.items())
    return f"{told} {value}"


def _unit(unit: str | None) -> str:
    return "(unit not stated)" if unit is None else unit


def _now() -> datetime:
    return datetime.now(UTC)


def _maybe(value: float | None) -> str:
    return "\N{EN DASH}" if value is None else number(value)


def _day(at: datetime) -> str:
    return f"{at:%Y-%m-%d}"


def _moment(at: datetime) -> str:
    return f"{at:%Y-%m-%d %H:%M:%S} UTC"


def _plural(count: int, noun: str) -> str:
    return f"{count:,} {noun}" if count == 1 else f"{count:,} {noun}s"


def _thing_url(dataset: str, name: str) -> str:
    return f"/objects/{thing_address(ThingRef(dataset, name))}"


def search(path: str, **values: str) -> str:
    """An address with what is asked of it."""
    return f"{path}?{urlencode(values)}"


def with_query(path: str, query: QueryParams, **changes: str | None) -> str:
    """The same address with other parameters, each as often as it was given; one that is None is left out."""
    same = [(name, value) for name, value in query.multi_items() if name not in changes]
    asked = urlencode([*same, *((name, value) for name, value in changes.items() if value is not None)])
    return f"{path}?{asked}" if asked else path


@lru_cache(maxsize=32)
def _asset(name: str) -> str:
    """The address of a file of the site, another one for another content, so that browsers may keep it."""
    return f"/static/{name}?v={sha256((STATIC / name).read_bytes()).hexdigest()[:12]}"
