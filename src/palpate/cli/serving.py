"""What `palpate serve` does before it serves: the store, and a word on where to look."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from palpate.cli.store_options import Place

if TYPE_CHECKING:
    from palpate.server.running import Address, PublicAddress
    from palpate.server.settings import Settings

__all__ = ["ready_store", "tell"]


def ready_store(place: Place, *, example: bool) -> None:
    """Make the store where there is none, before workers do so at once; add the example data where that is asked."""
    with place.opened(make=True) as store:
        if example:
            from palpate.server.example import add_example

            print("adding the example data ...", file=sys.stderr)
            add_example(store)


def tell(settings: Settings, address: Address | PublicAddress) -> None:
    """Say where it is."""
    print(f"Palpate is at {address.url}/ as the public sees it.", flush=True)
    if settings.key is not None:
        print(f"As the owner of the store: {address.url}/enter?key={settings.key}", flush=True)
    print("Stop it with Ctrl-C.", flush=True)
