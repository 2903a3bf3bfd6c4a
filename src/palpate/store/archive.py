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

import json
import shutil
import tempfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.store.archive_episodes import EPISODES, read_episodes, write_episodes
from palpate.store.archive_rows import entries_schema, entry_row, recording_at, recording_row, recordings_schema
from palpate.store.archive_things import OBJECTS, import_things, write_things
from palpate.store.blobs import FolderBlobs
from palpate.store.content import file_digest, to_json
from palpate.store.decoding import recording_from
from palpate.store.errors import DamagedError, StoreError
from palpate.store.fetching import fetch, id_chunks
from palpate.store.keeping_episodes import put_episode
from palpate.store.records import Recording
from palpate.store.schema import recordings
from palpate.store.store import Store

if TYPE_CHECKING:
    import pyarrow
    from pyarrow.parquet import ParquetWriter

__all__ = ["Imported", "export_archive", "import_archive", "read_archive"]

VERSION = 1
AT_ONCE = 200
TABLES = ("entries.parquet", "recordings.parquet")
MORE_TABLES = (EPISODES, OBJECTS)


@dataclass
class Imported:
    """What became of the recordings of an archive, of its episodes, and of what it says of objects."""

    new: int = 0
    known: int = 0
    refused: list[str] = field(default_factory=list)
    episodes: int = 0


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


def import_archive(store: Store, folder: Path) -> Imported:
    """Put all that an archive holds into a store; what is there already stays as it is.

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
    if (folder / OBJECTS).is_file():
        imported.refused += import_things(store, folder)
    if (folder / EPISODES).is_file():
        _put_episodes(store, folder, imported)
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


def _put_episodes(store: Store, folder: Path, imported: Imported) -> None:
    for episode in read_episodes(folder):
        try:
            imported.episodes += put_episode(store, episode).new
        except StoreError as error:
            imported.refused.append(f"episode {episode.id}: {error}")


def _write(store: Store, folder: Path) -> int:
    from pyarrow.parquet import ParquetWriter

    kept, count = FolderBlobs(folder / "blobs"), 0
    with (
        store.engine.connect() as connection,
        ParquetWriter(folder / "recordings.parquet", recordings_schema(), compression="zstd") as heads,
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
        version, written = manifest["version"], manifest["sha256"]
        digests = {name: written[name] for name in (*TABLES, *(name for name in MORE_TABLES if name in written))}
    except FileNotFoundError:
        raise StoreError(f"{path}: is missing, expected the folder of an archive") from None
    except (ValueError, TypeError, KeyError):
        raise StoreError(f"{path}: cannot be read, expected the manifest of an archive") from None
    if version != VERSION:
        raise StoreError(f"{path}: version {version!r}, expected {VERSION}: update palpate")
    for name in MORE_TABLES:
        if name not in digests and (folder / name).exists():
            raise DamagedError(f"{folder / name}: is not among the files of {path.name}")
    for name, digest in digests.items():
        if not (folder / name).is_file() or file_digest(folder / name) != digest:
            raise DamagedError(f"{folder / name}: is missing or not the file that was written with {path.name}")
