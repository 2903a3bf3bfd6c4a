"""`palpate serve`: the store as a web service and as pages."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Annotated

import typer

from palpate.cli.address_options import AddressOptions
from palpate.cli.provider_options import ProviderOptions
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place
from palpate.errors import PalpateError, extra

__all__ = ["serve"]

NEEDED = ("fastapi", "uvicorn", "jinja2", "prometheus_client")


@spread
def serve(
    place: Place,
    where: AddressOptions,
    provider: ProviderOptions,
    workers: Annotated[int, typer.Option(min=1, help="Processes that answer.")] = 1,
    example: Annotated[bool, typer.Option("--example", help="Add the example data first.")] = False,
    signed_urls: Annotated[
        bool, typer.Option("--signed-urls", help="Send who may see a file to the bucket that has it, for a minute.")
    ] = False,
    log: Annotated[bool, typer.Option("--log", help="Print each request as a line of JSON to standard error.")] = False,
    contact: Annotated[
        str | None, typer.Option(metavar="TEXT", help="Whom to ask for an account or a password, for the log-in page.")
    ] = None,
    rate: Annotated[
        float | None,
        typer.Option(
            min=0.1, help="Requests a second from one address (50 unless only for this computer); ten times by tokens."
        ),
    ] = None,
) -> None:
    """Serve the store as pages and as a web service, until interrupted."""
    check_installed()
    elsewhere = provider.settings()
    from palpate.cli.serving import check_signing, ready_store, tell
    from palpate.server.running import local_key
    from palpate.server.running import serve as run
    from palpate.server.settings import Settings

    address, reached = where.address(), where.reached()
    alone = address.is_local and where.public is None
    if signed_urls:
        check_signing(place)
    address.check_free()
    ready_store(place, example=example)
    settings = Settings(
        place.place,
        place.blobs,
        hosts=reached.names,
        key=local_key() if alone else None,
        requests_per_s=rate or (None if alone else 50.0),
        secure=reached.is_secure,
        proxied=where.public is not None,
        signed_urls=signed_urls,
        log_requests=log,
        contact=contact,
        **elsewhere,
    )
    run(settings, address, lambda: tell(settings, reached), workers=workers)


def check_installed() -> None:
    """Say what is missing where the package was installed without what a server needs."""
    from palpate.cli.storing import check_installed as check_store

    check_store()
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise PalpateError(f"palpate serve needs {missing[0]}, which is not installed: {extra('server')}")
