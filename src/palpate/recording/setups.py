"""Setups from TOML files: the devices that measure.

A table for each of ``arm``, ``gripper``, ``camera`` and ``microphone``, any number of ``[[other]]``; each has a
``name``, and may have a ``maker``, ``parameters``, a ``calibration`` and the date ``calibrated_on``.
"""

from __future__ import annotations

import tomllib
from pathlib import Path

from palpate.recording.errors import RecordingError
from palpate.store.errors import StoreError
from palpate.store.records import Setup
from palpate.store.setups import setup_from_tables

__all__ = ["read_setup"]


def read_setup(path: str | Path) -> Setup:
    """Read a setup.

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
