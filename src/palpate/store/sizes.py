"""How much one recording may say: every list that has it reads all of that, but for signals, files and log."""

from __future__ import annotations

from palpate.store.content import setup_plain, thing_plain, to_json
from palpate.store.errors import StoreError
from palpate.store.records import Recording

__all__ = ["check_amounts", "check_sizes"]

MOST_ENTRIES = MOST_NOTICES = MOST_ALIASES = 1000
LONGEST_LOG = 16 << 20
"""Letters."""
LARGEST_JSON_BYTES = 1 << 20


def check_amounts(recording: Recording) -> None:
    """Refuse more results, notices, other names or log than one measurement has, before looking at each.

    Raises
    ------
    StoreError
        Naming the field.
    """
    for field, found, most in (
        ("entries", recording.entries, MOST_ENTRIES),
        ("notices", recording.notices, MOST_NOTICES),
        ("thing.aliases", recording.thing.aliases, MOST_ALIASES),
    ):
        if len(found) > most:
            raise StoreError(f"{field}: found {len(found)}, expected {most} at most of one measurement")
    if len(recording.log) > LONGEST_LOG:
        raise StoreError(f"log: found {len(recording.log)} letters, expected {LONGEST_LOG} at most; a file holds more")


def check_sizes(recording: Recording) -> None:
    """Refuse a recording, object or setup of which more is said than 1 MiB of JSON.

    All of it can be written as JSON, which `palpate.store.checks.check` has found before.

    Raises
    ------
    StoreError
        Naming the part that is too large.
    """
    for field, text in (
        ("recording", recording.document),
        ("thing", to_json(thing_plain(recording.thing))),
        ("setup", to_json(setup_plain(recording.setup))),
    ):
        size_bytes = len(text.encode())
        if size_bytes > LARGEST_JSON_BYTES:
            told = f"{size_bytes} bytes of JSON, expected {LARGEST_JSON_BYTES} at most; series and files hold more"
            raise StoreError(f"{field}: {told}")
