"""`palpate serve`: the store as a web service and as pages."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Annotated

import typer

from palpate.cli.provider_options import ProviderOptions
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place
from palpate.errors import PalpateError, extra

__all__ = ["serve"]

NEEDED = ("fastapi", "uvicorn", "jinja2", "prometheus_client")


@spread
def serve(
    place: Place,
    provider: ProviderOptions,
    host: Annotated[str, typer.Option(help="Address to listen at; others reach it only where this is not local.")] = (
        "127.0.0.1"
    ),
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen at.")] = 8000,
    workers: Annotated[int, typer.Option(min=1, help="Processes that answer.")] = 1,
    example: Annotated[bool, typer.Option("--example", help="Add the example data first.")] = False,
    public: Annotated[
        str | None, typer.Option(metavar="URL", help="Address by which people reach it, where a proxy passes them on.")
    ] = None,
    signed_urls: Annotated[
        bool, typer.Option("--signed-urls", help="Send who may see a file to the bucket that has it, for a minute.")
    ] = False,
    log: Annotated[bool, typer.Option("--log", help="Print each request as a line of JSON to standard error.")] = False,
    rate: Annotated[
        float | None,
        typer.Option(min=0.1, help="Requests a second from one address; 50 unless only for this computer."),
    ] = None,
) -> None:
    """Serve the store as pages and as a web service, until interrupted."""
    check_installed()
    elsewhere = provider.settings()
    from palpate.cli.serving import ready_store, tell
    from palpate.server.running import Address, PublicAddress, local_key
    from palpate.server.running import serve as run
    from palpate.server.settings import Settings

    address, reached = Address(host, port), None if public is None else PublicAddress.of(public)
    alone = address.is_local and reached is None
    ready_store(place, example=example, signed_urls=signed_urls)
    settings = Settings(
        place.place,
        place.blobs,
        hosts=address.names if reached is None else reached.names,
        key=local_key() if alone else None,
        requests_per_s=rate or (None if alone else 50.0),
        secure=reached is not None and reached.is_secure,
        signed_urls=signed_urls,
        log_requests=log,
        **elsewhere,
    )
    tell(settings, address if reached is None else reached)
    run(settings, address, workers=workers)


def check_installed() -> None:
    """Say what is missing where the package was installed without what a server needs."""
    from palpate.cli.storing import check_installed as check_store

    check_store()
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise PalpateError(f"palpate serve needs {missing[0]}, which is not installed: {extra('server')}")
