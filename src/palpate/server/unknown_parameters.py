"""Parameters of an address that the service does not know: passed over, nobody would notice that they are mistyped."""

from __future__ import annotations

from fastapi import Request
from fastapi.dependencies.utils import get_flat_params

from palpate.server.problems import problem

__all__ = ["check_known"]


async def check_known(request: Request) -> None:
    """Refuse, with a 422, what is no parameter of an address and not empty, as ``?fields=id`` of a recording."""
    given = dict.fromkeys(name for name, value in request.query_params.multi_items() if value)
    if not given:
        return
    known = {one.alias for one in get_flat_params(request.scope["route"].dependant)}
    told = [
        {"field": f"query.{name}", "detail": "is not known here, leave it out"} for name in given if name not in known
    ]
    if told:
        raise problem(422, "; ".join(f"{one['field']}: {one['detail']}" for one in told[:3]), told)
