"""What the tests of exports share."""

from dataclasses import replace
from pathlib import Path
from typing import Any

from palpate.store.exporting.publication import Terms
from palpate.store.exporting.writing import Format, Written, export
from palpate.store.filters import Filter
from palpate.store.records import Recording
from palpate.store.store import Store
from tests.store.made_up import squeeze

TERMS = Terms(authors=("Doe, Jane", "the lab"), licence="CC-BY-4.0", include_private=True)


def public(number: int, **changes: Any) -> Recording:
    """A recording that may be given to others."""
    return replace(squeeze(number), **{"visibility": "public", "owner": "our lab", "licence": "CC-BY-4.0", **changes})


def written(store: Store, form: Format, folder: Path, wanted: Filter | None = None) -> Written:
    return export(store, form, folder, wanted)
