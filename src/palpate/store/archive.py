"""Palpate's own archive: a folder that holds recordings whole, for exchange and for back-up.

``manifest.json``
    Version, count, and the SHA-256 of the other files.
``recordings.parquet``
    One row for each recording: what was hashed, what it refers to, and its raw signals, compressed.
``entries.parquet``
    One row for each result, for queries; an import does without.
``blobs/``
    Files, under their SHA-256.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.store.archive_rows import entries_schema, entry_row, recording_at, recording_row, recordings_schema
from palpate.store.blobs import FolderBlobs
from palpate.store.content import file_digest, to_json
from palpate.store.errors import DamagedError, StoreError
from palpate.store.exporting.selection import Selection
from palpate.store.exporting.writing import Told, Written, export
from palpate.store.filters import Filter
from palpate.store.records import Recording
from palpate.store.store import Store

if TYPE_CHECKING:
    import pyarrow
    from pyarrow.parquet import ParquetWriter

__all__ = ["Archive", "Imported", "export_archive", "import_archive", "read_archive"]

VERSION = 1
AT_ONCE = 200
TABLES = ("entries.parquet", "recordings.parquet")


@dataclass
class Imported:
    """What became of the recordings of an archive."""

    new: int = 0
    known: int = 0
    refused: list[str] = field(default_factory=list)


def export_archive(store: Store, folder: Path, wanted: Filter | None = None, told: Told = lambda done, of: None) -> int:
    """Write recordings of a store as an archive.

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
        return Written(_write(selection, folder, told))


def import_archive(store: Store, folder: Path) -> Imported:
    """Put all recordings of an archive into a store; those that are there already stay as they are.

    Raises
    ------
    StoreError
        If it is no archive, or one of a newer version.
    DamagedError
        If a file of the archive is not the one that was written.
    """
    imported = Imported()
    batch: list[Recording] = []
    for recording in read_archive(folder):
        batch.append(recording)
        if len(batch) == AT_ONCE:
            _put(store, batch, imported)
            batch = []
    _put(store, batch, imported)
    return imported


def read_archive(folder: Path) -> Iterator[Recording]:
    """Give the recordings of an archive, each one verified; files stay where they are until they are read.

    Raises
    ------
    StoreError, DamagedError
        As `import_archive`.
    """
    import pyarrow.parquet

    _check_manifest(folder)
    table = pyarrow.parquet.ParquetFile(folder / "recordings.parquet")
    if not table.schema_arrow.equals(recordings_schema()):
        raise StoreError(f"{folder / 'recordings.parquet'}: has other columns, expected those of version {VERSION}")
    for batch in table.iter_batches(batch_size=AT_ONCE):
        for row in batch.to_pylist():
            yield recording_at(row, folder)


def _put(store: Store, batch: Sequence[Recording], imported: Imported) -> None:
    """Put recordings at once; where one is refused, each by itself."""
    try:
        receipts = store.put_many(batch)
    except DamagedError:
        raise
    except StoreError as error:
        if len(batch) > 1:
            for recording in batch:
                _put(store, [recording], imported)
        else:
            imported.refused.append(f"recording {batch[0].id}: {error}")
        return
    imported.new += sum(receipt.new for receipt in receipts)
    imported.known += sum(not receipt.new for receipt in receipts)


def _write(selection: Selection, folder: Path, told: Told) -> int:
    from pyarrow.parquet import ParquetWriter

    kept, count, of = FolderBlobs(folder / "blobs"), 0, selection.count()
    with (
        ParquetWriter(folder / "recordings.parquet", recordings_schema(), compression="zstd") as heads,
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
    digests = {name: file_digest(folder / name) for name in TABLES}
    manifest = {"format": "palpate archive", "version": VERSION, "recordings": count, "sha256": digests}
    (folder / "manifest.json").write_text(to_json(manifest) + "\n", encoding="utf-8")
    return count


def _write_rows(writer: ParquetWriter, schema: pyarrow.Schema, rows: list[dict[str, Any]]) -> None:
    import pyarrow

    if rows:
        writer.write_table(pyarrow.Table.from_pylist(rows, schema=schema))


def _check_manifest(folder: Path) -> None:
    path = folder / "manifest.json"
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
        version, digests = manifest["version"], {name: manifest["sha256"][name] for name in TABLES}
    except FileNotFoundError:
        raise StoreError(f"{path}: is missing, expected the folder of an archive") from None
    except (ValueError, TypeError, KeyError):
        raise StoreError(f"{path}: cannot be read, expected the manifest of an archive") from None
    if version != VERSION:
        raise StoreError(f"{path}: version {version!r}, expected {VERSION}: update palpate")
    for name, digest in digests.items():
        if not (folder / name).is_file() or file_digest(folder / name) != digest:
            raise DamagedError(f"{folder / name}: is missing or not the file that was written with {path.name}")
