"""Setups from TOML files; `palpate.store.importing.setup_tables` says what stands in them."""

from __future__ import annotations

import tomllib
from pathlib import Path

from palpate.recording.errors import RecordingError
from palpate.store.errors import StoreError
from palpate.store.importing.setup_tables import setup_from_tables
from palpate.store.records import Setup

__all__ = ["read_setup"]


def read_setup(path: str | Path) -> Setup:
    """Read a setup: a table for each of arm, gripper, camera and microphone, and any number of ``[[other]]``.

    Raises
    ------
    RecordingError
        If the file cannot be read, or a key is missing, unknown or holds something else.
    """
    try:
        return setup_from_tables(tomllib.loads(Path(path).read_text(encoding="utf-8")), str(path))
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from error
    except StoreError as error:
        raise RecordingError(str(error)) from error
    except ValueError as error:
        raise RecordingError(f"{path}: is no readable TOML: {error}") from error
