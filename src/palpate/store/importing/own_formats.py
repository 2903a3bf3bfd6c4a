"""What Palpate writes itself: archives and the recordings of a spool, to be imported, and exports for others."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from functools import partial
from pathlib import Path

from palpate.store.archive import MANIFEST, NAME, RECORDINGS
from palpate.store.importing.archive_more import more_of_archive
from palpate.store.importing.folder import JOURNAL
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.importing.reading_folder import read_folder, stated_digest
from palpate.store.reading_archive import archive_rows, stated_count, stated_units
from palpate.store.store import Store

__all__ = ["EXAMPLE", "Archives", "Exports", "RecordingFolders"]

EXAMPLE = Path(__file__).parents[2] / "data" / "example_archive"
"""An archive that the package ships: one session of a robot with one object."""

DIGEST = re.compile("[0-9a-f]{64}")
DEPTH = 4
"""Folders in which a table of an export is at most."""
BEGINNING = 4096
"""Characters of a manifest in which the name of the format stands."""
FOR_OTHERS = (
    "is an export for others, which does not hold all that recordings are: import an archive, as "
    "`palpate store export FOLDER` writes it"
)


class Archives:
    """The folder of an archive: recordings, episodes, and what is known of objects."""

    def owns(self, path: Path) -> bool:
        """Tell whether it is a folder with a manifest, and a table or the format's name in it."""
        manifest = path / MANIFEST
        if not manifest.is_file():
            return False
        with manifest.open(encoding="utf-8", errors="replace") as opened:
            return (path / RECORDINGS).exists() or NAME in opened.read(BEGINNING)

    def count(self, path: Path) -> int:
        """As many recordings and episodes as the manifest states."""
        return stated_count(path)

    def items(self, path: Path) -> Iterator[Item]:
        """The recordings; what is there already need not be read, as its digest is stated."""
        for row in archive_rows(path):
            digest = row.digest if DIGEST.fullmatch(row.digest or "") else None
            yield Item(f"{path}: recording {row.id}", row.read, digest, row.is_known_wrong, was_kept=True)

    def units(self, path: Path) -> Mapping[str, str]:
        """Property to its unit: a result that is known to be wrong must not decide, though it may be the first."""
        return stated_units(path)

    def put_more(self, path: Path, store: Store) -> Iterator[Outcome]:
        """What is said of objects, and the episodes; what the store has or says already stays."""
        return more_of_archive(store, path)


class RecordingFolders:
    """The folder of one recording, as a spool has it."""

    def owns(self, path: Path) -> bool:
        """Tell whether there is a journal."""
        return (path / JOURNAL).is_file()

    def count(self, path: Path) -> int:
        """One."""
        return 1

    def items(self, path: Path) -> Iterator[Item]:
        """The recording; its digest is the last thing in the journal."""
        digest = stated_digest(path)
        yield Item(str(path), partial(read_folder, path), digest if DIGEST.fullmatch(digest or "") else None)


class Exports:
    """What `palpate store export` writes in other formats than that of an archive: nothing to import."""

    def owns(self, path: Path) -> bool:
        """Tell whether it is the folder of an export, or a table in one."""
        folders = (path, *path.parents[:DEPTH]) if path.suffix == ".parquet" else (path,)
        return any(_is_export(folder) for folder in folders)

    def count(self, path: Path) -> int:
        """One."""
        return 1

    def items(self, path: Path) -> Iterator[Outcome]:
        """What it is."""
        yield Outcome(str(path), Fate.SKIPPED, FOR_OTHERS)


def _is_export(folder: Path) -> bool:
    described = (folder / "croissant.json").is_file() and (folder / "CITATION.cff").is_file()
    return described and any(
        next(folder.glob(table), None) for table in ("data/recordings-*.parquet", "meta/info.json")
    )
