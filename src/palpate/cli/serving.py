"""What `palpate serve` does before it serves: the store, and a word on where to look."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from palpate.cli.store_options import Place
from palpate.errors import PalpateError

if TYPE_CHECKING:
    from palpate.server.running import Address, PublicAddress
    from palpate.server.settings import Settings

__all__ = ["check_signing", "ready_store", "tell"]


def ready_store(place: Place, *, example: bool) -> None:
    """Make the store where there is none, before workers do so at once; add the example data where that is asked."""
    with place.opened(make=True) as store:
        if example:
            from palpate.server.example import add_example

            print("adding the example data ...", file=sys.stderr)
            add_example(store)


def check_signing(place: Place) -> None:
    """Refuse to begin what would fail at the first file.

    Raises
    ------
    PalpateError
        If there is no bucket of which addresses can be signed, or no key to do it with.
    """
    from palpate.store.bucket import BucketBlobs
    from palpate.store.opening import blobs_of

    blobs = blobs_of(place.place, place.blobs)
    if not isinstance(blobs, BucketBlobs):
        raise PalpateError("--signed-urls: the blobs are in a folder, expected a bucket such as --blobs s3://lab/blobs")
    blobs.signed_url("0" * 64, 1.0, "application/octet-stream", "attachment")


def tell(settings: Settings, address: Address | PublicAddress) -> None:
    """Say where it is."""
    print(f"Palpate is at {address.url}/ as the public sees it.", flush=True)
    if settings.key is not None:
        print(f"As the owner of the store: {address.url}/enter?key={settings.key}", flush=True)
    print("Stop it with Ctrl-C.", flush=True)
