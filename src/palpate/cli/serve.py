"""`palpate serve`: the store as a web service and as pages."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Annotated

import typer

from palpate.cli.spreading import spread
from palpate.cli.store_options import Place
from palpate.errors import PalpateError

__all__ = ["serve"]

NEEDED = ("fastapi", "uvicorn", "jinja2", "prometheus_client")


@spread
def serve(
    place: Place,
    host: Annotated[str, typer.Option(help="Address to listen at; others reach it only where this is not local.")] = (
        "127.0.0.1"
    ),
    port: Annotated[int, typer.Option(min=1, max=65535, help="Port to listen at.")] = 8000,
    workers: Annotated[int, typer.Option(min=1, help="Processes that answer.")] = 1,
    example: Annotated[bool, typer.Option("--example", help="Add the example data first.")] = False,
    secure: Annotated[
        bool, typer.Option("--secure", help="People reach it over TLS, by a proxy: tell browsers to insist on it.")
    ] = False,
    log: Annotated[bool, typer.Option("--log", help="Print each request as a line of JSON to standard error.")] = False,
    rate: Annotated[
        float | None, typer.Option(min=0.1, help="Requests a second from one address; 50 unless local.")
    ] = None,
) -> None:
    """Serve the store as pages and as a web service, until interrupted."""
    check_installed()
    from palpate.cli.serving import ready_store, tell
    from palpate.server.running import Address, local_key
    from palpate.server.running import serve as run
    from palpate.server.settings import Settings

    address = Address(host, port)
    ready_store(place, example=example)
    settings = Settings(
        place.place,
        place.blobs,
        hosts=address.names,
        key=local_key() if address.is_local else None,
        requests_per_s=rate or (None if address.is_local else 50.0),
        secure=secure,
        log_requests=log,
    )
    tell(settings, address)
    run(settings, address, workers=workers)


def check_installed() -> None:
    """Say what is missing where the package was installed without what a server needs."""
    from palpate.cli.storing import check_installed as check_store

    check_store()
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise PalpateError(f'palpate serve needs {missing[0]}, which is not installed: pip install "palpate[server]"')
