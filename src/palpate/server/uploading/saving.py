"""Files that somebody sends, saved into a folder within the limits of the server."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import IO

from palpate.server.receiving import check_parts
from palpate.store.errors import StoreError
from palpate.store.importing.paths import check_name
from palpate.store.importing.saving import Saved, is_zip

__all__ = ["save"]


def save(files: Iterator[tuple[str, IO[bytes]]], folder: Path, largest_bytes: int) -> list[tuple[str, str]]:
    """Save files, and give name and reason of each that is refused."""
    saved, refused = Saved(folder, largest_bytes), list[tuple[str, str]]()
    for name, data in files:
        try:
            if is_zip(name):
                check_parts(data)
            saved.put(name, data)
            if is_zip(name) and not any((folder / check_name(name, "name")).iterdir()):
                raise StoreError("the zip is empty")
        except StoreError as error:
            refused.append((name, str(error).removeprefix(f"{name}: ").removeprefix("package: ")))
    return refused
