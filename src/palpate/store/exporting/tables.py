"""Tables in Parquet, with a description for machines and one of how to cite them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from palpate.store.exporting.citation import citation_file
from palpate.store.exporting.columns import OBJECTS, SETUPS, TABLES, Table
from palpate.store.exporting.croissant import Described, croissant_file
from palpate.store.exporting.publication import Publication, Terms, publication
from palpate.store.exporting.rows import object_rows, rows_of, setup_rows
from palpate.store.exporting.selection import Selection
from palpate.store.exporting.shards import SHARD_BYTES, Shard, ShardWriter
from palpate.store.exporting.writing import Told, Written
from palpate.store.units import deciding_units

__all__ = ["Tables", "withheld", "write_tables"]


@dataclass(frozen=True)
class Tables:
    """Recordings as tables in Parquet, one row for each recording, result, channel, object, device and file.

    ``data/``
        The tables, each in one file or several; one without rows is left out.
    ``croissant.json``
        What is in them, for machines (Croissant 1.0).
    ``CITATION.cff``
        How to cite them.

    Attributes
    ----------
    terms
        Title, authors and licence.
    shard_bytes
        A file that is so large [B] is followed by another.
    """

    terms: Terms = field(default_factory=Terms)
    shard_bytes: int = SHARD_BYTES

    def write(self, selection: Selection, folder: Path, told: Told) -> Written:
        """Write the tables and what describes them."""
        given, data = publication(selection, self.terms)
        write_tables(given, data, folder, told, self.shard_bytes)
        return Written(data.census.recordings, withheld=withheld(selection, data))


def write_tables(
    selection: Selection, data: Publication, folder: Path, told: Told, shard_bytes: int
) -> Mapping[Table, list[Shard]]:
    """Write the tables of a selection, ``croissant.json`` and ``CITATION.cff``; give the files of each table."""
    shards = _write(selection, data, folder, told, shard_bytes)
    described = [Described(table, files) for table, files in shards.items()]
    (folder / "croissant.json").write_text(croissant_file(data, described, folder), encoding="utf-8")
    (folder / "CITATION.cff").write_text(citation_file(data), encoding="utf-8")
    return shards


def withheld(selection: Selection, data: Publication) -> int:
    """How many recordings were not given although they were asked for, as they are not public."""
    return selection.count() - data.census.recordings


def _write(
    selection: Selection, data: Publication, folder: Path, told: Told, shard_bytes: int
) -> Mapping[Table, list[Shard]]:
    done = 0
    with ExitStack() as stack:
        writers = {
            table: stack.enter_context(ShardWriter(table.schema, _drafts(folder, table), shard_bytes))
            for table in TABLES
        }
        units = deciding_units(selection.connection)
        for batch in selection.batches():
            for table, rows in rows_of(batch, units).items():
                writers[table].write([table.of(rows)])
            done += len(batch)
            told(done, data.census.recordings)
        writers[OBJECTS].write([OBJECTS.of(list(object_rows(data.census, selection.connection)))])
        writers[SETUPS].write([SETUPS.of(list(setup_rows(data.census)))])
    return {table: _numbered(table, writer.shards) for table, writer in writers.items() if writer.shards}


def _drafts(folder: Path, table: Table) -> Callable[[int], Path]:
    """Where the files of a table are while it is not known how many they will be."""
    return lambda number: folder / "data" / f"{table.name}-{number:05}.parquet"


def _numbered(table: Table, shards: Sequence[Shard]) -> list[Shard]:
    """The same files under names that say how many they are, as Hugging Face names them."""
    found = []
    for number, shard in enumerate(shards):
        path = shard.path.with_name(f"{table.name}-{number:05}-of-{len(shards):05}.parquet")
        found.append(Shard(shard.path.rename(path), shard.rows))
    return found
