"""Palpate's own archive: a folder that holds recordings whole, for exchange and for back-up.

``manifest.json``
    Version, count, and the SHA-256 of the other files.
``recordings.parquet``
    One row for each recording: what was hashed, what it refers to, and its raw signals, compressed.
``entries.parquet``
    One row for each result, for queries; an import does without.
``objects.parquet``, ``episodes.parquet``
    What is said and known of each object; the lines of each exploration. An archive may lack them.
``blobs/``
    Files, under their SHA-256.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.store.archive_episodes import EPISODES, write_episodes
from palpate.store.archive_rows import entries_schema, entry_row, recording_row, recordings_schema
from palpate.store.archive_things import OBJECTS, write_things
from palpate.store.blobs import FolderBlobs
from palpate.store.content import file_digest, to_json
from palpate.store.exporting.selection import Selection
from palpate.store.exporting.writing import Told, Written, export
from palpate.store.filters import Filter
from palpate.store.store import Store

if TYPE_CHECKING:
    import pyarrow
    from pyarrow.parquet import ParquetWriter

__all__ = ["MANIFEST", "MORE_TABLES", "NAME", "RECORDINGS", "TABLES", "VERSION", "Archive", "export_archive"]

NAME = "palpate archive"
VERSION = 1
MANIFEST, RECORDINGS = "manifest.json", "recordings.parquet"
TABLES = ("entries.parquet", RECORDINGS)
MORE_TABLES = (EPISODES, OBJECTS)
"""Tables that archives of older versions of the package do not have."""
PARTS = "what is known of objects, and episodes, are only in archives of all recordings"


def export_archive(store: Store, folder: Path, wanted: Filter | None = None, told: Told = lambda done, of: None) -> int:
    """Write recordings of a store as an archive; where they are all, with its objects and episodes.

    The archive appears whole or not at all: it is written beside and renamed.

    Parameters
    ----------
    store
        What to export.
    folder
        Must not exist yet.
    wanted
        Which recordings; all, unless given.
    told
        Is told how far it is.

    Returns
    -------
    int
        How many recordings were written.

    Raises
    ------
    StoreError
        If the folder exists.
    DamagedError
        If a recording is not what was put into the store.
    """
    return export(store, Archive(), folder, wanted, told).recordings


@dataclass(frozen=True)
class Archive:
    """The project's own archive, as a format of an export: what it holds can be imported whole."""

    def write(self, selection: Selection, folder: Path, told: Told) -> Written:
        """Write recordings, results, blobs and the manifest."""
        left = () if selection.is_all else (PARTS,)
        return Written(_write(selection, folder, told), left)


def _write(selection: Selection, folder: Path, told: Told) -> int:
    from pyarrow.parquet import ParquetWriter

    kept, count, of = FolderBlobs(folder / "blobs"), 0, selection.count()
    with (
        ParquetWriter(folder / RECORDINGS, recordings_schema(), compression="zstd") as heads,
        ParquetWriter(folder / "entries.parquet", entries_schema(), compression="zstd") as entries,
    ):
        for batch in selection.batches():
            _write_rows(heads, recordings_schema(), [recording_row(recording) for recording in batch])
            rows = [entry_row(recording, entry) for recording in batch for entry in recording.entries]
            _write_rows(entries, entries_schema(), rows)
            for item in (item for recording in batch for item in recording.files):
                kept.put(item.sha256, item.data)
            count += len(batch)
            told(count, of)
    more, episodes = MORE_TABLES if selection.is_all else (), 0
    if more:
        with selection.store.engine.connect() as connection:
            write_things(connection, selection.store.blobs, folder, kept)
            episodes = write_episodes(connection, folder)
    digests = {name: file_digest(folder / name) for name in (*TABLES, *more)}
    manifest = {"format": NAME, "version": VERSION, "recordings": count, "episodes": episodes, "sha256": digests}
    (folder / MANIFEST).write_text(to_json(manifest) + "\n", encoding="utf-8")
    return count


def _write_rows(writer: ParquetWriter, schema: pyarrow.Schema, rows: list[dict[str, Any]]) -> None:
    import pyarrow

    if rows:
        writer.write_table(pyarrow.Table.from_pylist(rows, schema=schema))
