"""Reading an archive: its recordings one by one, each verified before it is given."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.store.archive import MANIFEST, MORE_TABLES, RECORDINGS, TABLES, VERSION
from palpate.store.archive_rows import recording_at, recordings_schema
from palpate.store.content import file_digest
from palpate.store.decoding import moment_from
from palpate.store.embargo import Embargoes, with_embargo
from palpate.store.errors import DamagedError, StoreError
from palpate.store.records import VISIBILITIES, Recording

if TYPE_CHECKING:
    from pyarrow.parquet import FileMetaData, ParquetFile

__all__ = [
    "ArchiveRow",
    "archive_rows",
    "check_archive",
    "opened_table",
    "read_archive",
    "stated_count",
    "stated_embargoes",
    "stated_units",
]


@dataclass(frozen=True, eq=False)
class ArchiveRow:
    """A recording of an archive that has not been read yet.

    Attributes
    ----------
    id, digest
        As the archive states them; what is read has this digest or is an error.
    read
        Reads it; its files stay where they are until they are read. Raises `DamagedError` if it is not what was
        written.
    is_known_wrong
        Whether the archive states that a result is in a unit of another dimension than its property's.
    """

    id: str
    digest: str
    read: Callable[[], Recording]
    is_known_wrong: bool


def read_archive(folder: Path) -> Iterator[Recording]:
    """Give the recordings of an archive, each one verified; files stay where they are until they are read.

    Raises
    ------
    StoreError
        If it is no archive, or one of a newer version.
    DamagedError
        If a file or a recording of the archive is not the one that was written.
    """
    return (row.read() for row in archive_rows(folder))


def archive_rows(folder: Path) -> Iterator[ArchiveRow]:
    """Give the recordings of an archive without reading their signals before they are asked for.

    Raises
    ------
    StoreError, DamagedError
        As `read_archive`.
    """
    check_archive(folder)
    path, manifest = folder / RECORDINGS, _manifest(folder)
    with opened_table(path) as table:
        if not table.schema_arrow.equals(recordings_schema()):
            raise StoreError(f"{path}: has other columns, expected those of version {VERSION}")
        metadata = table.metadata
    for group in range(metadata.num_row_groups):
        # a group is read at most once, when the first of its recordings is asked for, and forgotten with the last
        whole = cache(partial(_rows, path, metadata, group))
        for place, row in enumerate(_rows(path, metadata, group, ["id", "digest"])):
            read = partial(_recording, whole, place, folder, manifest.embargoed)
            yield ArchiveRow(row["id"], row["digest"], read, row["digest"] in manifest.wrong)


def stated_count(folder: Path) -> int:
    """How many recordings and episodes an archive states that it has.

    Raises
    ------
    StoreError
        If it is no archive.
    """
    return _manifest(folder).count


def stated_units(folder: Path) -> Mapping[str, str]:
    """Property to the unit that decides its dimension; none in archives of older versions of the package.

    Raises
    ------
    StoreError
        If it is no archive.
    """
    return _manifest(folder).units


def stated_embargoes(folder: Path) -> Embargoes:
    """What an archive states of embargoes; none in those of older versions of the package.

    Raises
    ------
    StoreError
        If it is no archive.
    """
    return _manifest(folder).embargoed


def check_archive(folder: Path) -> None:
    """Refuse an archive of another version, and one whose tables are not those that were written.

    Raises
    ------
    StoreError, DamagedError
        As `read_archive`.
    """
    manifest = _manifest(folder)
    if manifest.version != VERSION:
        raise StoreError(f"{folder / MANIFEST}: version {manifest.version!r}, expected {VERSION}: update palpate")
    for name in MORE_TABLES:
        if name not in manifest.digests and (folder / name).exists():
            raise DamagedError(f"{folder / name}: is not among the files of {MANIFEST}")
    for name, digest in manifest.digests.items():
        if not (folder / name).is_file() or file_digest(folder / name) != digest:
            raise DamagedError(f"{folder / name}: is missing or not the file that was written with {MANIFEST}")


@dataclass(frozen=True)
class _Manifest:
    """What a manifest states; units and wrong ones are not in those of older versions of the package."""

    version: Any
    count: int
    digests: Mapping[str, Any]
    units: Mapping[str, str]
    wrong: frozenset[str]
    embargoed: Embargoes


def _manifest(folder: Path) -> _Manifest:
    path = folder / MANIFEST
    try:
        manifest = json.loads(path.read_text(encoding="utf-8"))
        written = manifest["sha256"]
        return _Manifest(
            version=manifest["version"],
            count=int(manifest["recordings"]) + int(manifest.get("episodes", 0)),
            digests={name: written[name] for name in (*TABLES, *(name for name in MORE_TABLES if name in written))},
            units={str(name): str(unit) for name, unit in manifest.get("units", {}).items()},
            wrong=frozenset(manifest.get("wrong", ())),
            embargoed=_embargoes(manifest.get("embargoed", {})),
        )
    except FileNotFoundError:
        raise StoreError(f"{path}: is missing, expected the folder of an archive") from None
    except (AttributeError, ValueError, TypeError, KeyError, RecursionError):
        raise StoreError(f"{path}: cannot be read, expected the manifest of an archive") from None


def _embargoes(stated: Mapping[str, Any]) -> Embargoes:
    for visibility, until in stated.values():
        moment_from(until)
        if visibility not in VISIBILITIES:
            raise ValueError
    return {str(digest): (visibility, until) for digest, (visibility, until) in stated.items()}


@contextmanager
def opened_table(path: Path, metadata: FileMetaData | None = None) -> Iterator[ParquetFile]:
    """A table; what is wrong with it is a `DamagedError`."""
    from pyarrow import ArrowException
    from pyarrow.parquet import ParquetFile

    try:
        with ParquetFile(path, metadata=metadata) as table:
            yield table
    except ArrowException as error:
        raise DamagedError(f"{path}: cannot be read ({error}), expected a table that palpate wrote") from error


def _rows(path: Path, metadata: FileMetaData, group: int, columns: Sequence[str] | None = None) -> list[dict[str, Any]]:
    with opened_table(path, metadata) as table:
        rows: list[dict[str, Any]] = table.read_row_group(group, columns=columns).to_pylist()
    return rows


def _recording(
    rows: Callable[[], Sequence[Mapping[str, Any]]], place: int, folder: Path, embargoed: Embargoes
) -> Recording:
    return with_embargo(recording_at(rows()[place], folder), embargoed)
