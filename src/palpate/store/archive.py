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

import shutil
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.store.archive_episodes import EPISODES, write_episodes
from palpate.store.archive_rows import entries_schema, entry_row, recording_row, recordings_schema
from palpate.store.archive_things import OBJECTS, write_things
from palpate.store.blobs import FolderBlobs
from palpate.store.content import file_digest, to_json
from palpate.store.decoding import recording_from
from palpate.store.errors import StoreError
from palpate.store.fetching import fetch, id_chunks
from palpate.store.schema import recordings
from palpate.store.store import Store

if TYPE_CHECKING:
    import pyarrow
    from pyarrow.parquet import ParquetWriter

__all__ = ["MANIFEST", "MORE_TABLES", "NAME", "RECORDINGS", "TABLES", "VERSION", "export_archive"]

NAME = "palpate archive"
VERSION = 1
MANIFEST, RECORDINGS = "manifest.json", "recordings.parquet"
TABLES = ("entries.parquet", RECORDINGS)
MORE_TABLES = (EPISODES, OBJECTS)
"""Tables that archives of older versions of the package do not have."""
AT_ONCE = 200
"""Recordings that are written, and read again, together."""


def export_archive(store: Store, folder: Path) -> int:
    """Write all recordings of a store as an archive, with its objects and episodes.

    The archive appears whole or not at all: it is written beside and renamed.

    Parameters
    ----------
    store
        What to export.
    folder
        Must not exist yet.

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
    if folder.exists():
        raise StoreError(f"{folder}: exists already, expected the name of a new folder")
    folder.parent.mkdir(parents=True, exist_ok=True)
    draft = Path(tempfile.mkdtemp(prefix=f".{folder.name}-", dir=folder.parent))
    try:
        count = _write(store, draft)
        draft.chmod(0o755)
        draft.rename(folder)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return count


def _write(store: Store, folder: Path) -> int:
    from pyarrow.parquet import ParquetWriter

    kept, count = FolderBlobs(folder / "blobs"), 0
    with (
        store.engine.connect() as connection,
        ParquetWriter(folder / RECORDINGS, recordings_schema(), compression="zstd") as heads,
        ParquetWriter(folder / "entries.parquet", entries_schema(), compression="zstd") as entries,
    ):
        for ids in id_chunks(connection, AT_ONCE):
            batch = [recording_from(stored) for stored in fetch(connection, store.blobs, recordings.c.id.in_(ids))]
            _write_rows(heads, recordings_schema(), [recording_row(recording) for recording in batch])
            rows = [entry_row(recording, entry) for recording in batch for entry in recording.entries]
            _write_rows(entries, entries_schema(), rows)
            for item in (item for recording in batch for item in recording.files):
                kept.put(item.sha256, item.data)
            count += len(batch)
        write_things(connection, store.blobs, folder, kept)
        write_episodes(connection, folder)
    digests = {name: file_digest(folder / name) for name in (*TABLES, *MORE_TABLES)}
    manifest = {"format": NAME, "version": VERSION, "recordings": count, "sha256": digests}
    (folder / MANIFEST).write_text(to_json(manifest) + "\n", encoding="utf-8")
    return count


def _write_rows(writer: ParquetWriter, schema: pyarrow.Schema, rows: list[dict[str, Any]]) -> None:
    import pyarrow

    if rows:
        writer.write_table(pyarrow.Table.from_pylist(rows, schema=schema))
