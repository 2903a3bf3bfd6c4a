"""Palpate's own archive: a folder that holds recordings whole, for exchange and for back-up.

``manifest.json``
    Version, counts, the SHA-256 of the other files, the unit that decides the dimension of each property, the
    digests of recordings with results in a unit of another one, and of what is or was embargoed visibility and end.
``recordings.parquet``
    One row for each recording: what was hashed, what it refers to, and its raw signals, compressed.
``entries.parquet``
    One row for each result, for queries; an import does without.
``objects.parquet``
    What is said and known of each object. An archive of an older version of the package may lack it.
``episodes.parquet``
    The lines of each exploration. An archive of an older version of the package may lack it.
``blobs/``
    Files, under their SHA-256.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import func, select

from palpate.errors import plural
from palpate.store import schema
from palpate.store.archive_episodes import EPISODES, episodes_with, write_episodes
from palpate.store.archive_rows import entries_schema, entry_row, recording_row, recordings_schema
from palpate.store.archive_said import things_said
from palpate.store.archive_things import OBJECTS, things_with, write_things
from palpate.store.blobs import FolderBlobs
from palpate.store.content import file_digest, to_json
from palpate.store.embargo import Embargoes, embargo_stated
from palpate.store.exporting.selection import Selection
from palpate.store.exporting.writing import Told, Written, export
from palpate.store.filters import Filter
from palpate.store.registry import units_in
from palpate.store.rows import counted, has_wrong_unit
from palpate.store.store import Store
from palpate.store.units import deciding_units

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


def export_archive(store: Store, folder: Path, wanted: Filter | None = None, told: Told = lambda done, of: None) -> int:
    """Write recordings of a store as an archive, with their objects and the episodes that they make up.

    All of it is as the store was at one moment, and the archive appears whole or not at all: it is written beside and
    renamed.

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
        """Write recordings, results, objects, episodes, blobs and the manifest."""
        kept = FolderBlobs(folder / "blobs")
        units = deciding_units(selection.connection)
        count, used, wrong, hidden = _write_recordings(selection, folder, kept, units, told)
        episodes = episodes_with(selection)
        things = things_with(selection, episodes)
        pictures = write_things(selection, things, folder, kept)
        hidden = {**hidden, **write_episodes(selection.connection, episodes, folder)}
        digests = {name: file_digest(folder / name) for name in (*TABLES, *MORE_TABLES)}
        counts = {"recordings": count, "episodes": len(episodes)}
        more = {"units": used, "wrong": wrong, **({"embargoed": hidden} if hidden else {})}
        manifest = {"format": NAME, "version": VERSION, **counts, **more, "sha256": digests}
        (folder / MANIFEST).write_text(to_json(manifest) + "\n", encoding="utf-8")
        return Written(count, (*_left_out(selection, len(things), len(episodes)), *pictures))


def _left_out(selection: Selection, things: int, episodes: int) -> Iterator[str]:
    """What of the store is not in an archive beside the recordings that were not asked for."""
    for table, name, written, why in (
        (schema.things, "object", things, "about which nothing is in the archive"),
        (
            schema.episodes,
            "episode",
            episodes,
            "without recordings, with some that are not in the archive, or of another visibility",
        ),
    ):
        left = (selection.connection.scalar(select(func.count()).select_from(table)) or 0) - written
        if left:
            yield f"{plural(left, name)} left out ({why})"


def _write_recordings(
    selection: Selection, folder: Path, kept: FolderBlobs, units: Mapping[str, str], told: Told
) -> tuple[int, dict[str, str], list[str], Embargoes]:
    """How many recordings were written, the units of their properties, the digests of the wrong ones, and embargoes."""
    from pyarrow.parquet import ParquetWriter

    count, of, used, wrong = 0, selection.count(), dict[str, str](), list[str]()
    hidden: dict[str, tuple[str, str]] = {}
    with (
        ParquetWriter(folder / RECORDINGS, recordings_schema(), compression="zstd") as heads,
        ParquetWriter(folder / "entries.parquet", entries_schema(), compression="zstd") as entries,
    ):
        for batch in selection.batches():
            said = things_said(selection.connection, batch)
            rows = [recording_row(recording, said.get(recording.digest)) for recording in batch]
            _write_rows(heads, recordings_schema(), rows)
            rows = [counted(entry_row(recording, entry), units) for recording in batch for entry in recording.entries]
            _write_rows(entries, entries_schema(), rows)
            for item in (item for recording in batch for item in recording.files):
                kept.put(item.sha256, item.data)
            used |= {name: units[name] for recording in batch for _, (name, _) in units_in(recording)}
            wrong += [recording.digest for recording in batch if has_wrong_unit(recording, units)]
            hidden |= {digest: one for recording in batch for digest, one in embargo_stated(recording).items()}
            count += len(batch)
            told(count, of)
    return count, used, wrong, hidden


def _write_rows(writer: ParquetWriter, columns: pyarrow.Schema, rows: list[dict[str, Any]]) -> None:
    import pyarrow

    if rows:
        writer.write_table(pyarrow.Table.from_pylist(rows, schema=columns))
