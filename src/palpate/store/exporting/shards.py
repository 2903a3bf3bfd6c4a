"""A table in several Parquet files of bounded size."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import BinaryIO, Self

import pyarrow as pa
from pyarrow.parquet import ParquetWriter

from palpate.store.content import file_digest

__all__ = ["GROUP_BYTES", "GROUP_ROWS", "SHARD_BYTES", "Shard", "ShardWriter"]

SHARD_BYTES = 256 << 20
GROUP_ROWS, GROUP_BYTES = 2000, 16 << 20


@dataclass(frozen=True)
class Shard:
    """One of the files of a table, with how many rows are in it."""

    path: Path
    rows: int

    @property
    def sha256(self) -> str:
        """SHA-256 of the file, in hexadecimal digits."""
        return file_digest(self.path)


class ShardWriter:
    """Writes a table in parts; it begins another file where the one before has become large.

    Parameters
    ----------
    schema
        The columns.
    place
        Where a file is written, by its number from 0.
    most_bytes
        A file that has so many [B] is the last but one.
    """

    def __init__(self, schema: pa.Schema, place: Callable[[int], Path], most_bytes: int = SHARD_BYTES) -> None:
        self.schema, self.place, self.most_bytes = schema, place, most_bytes
        self.shards: list[Shard] = []
        self._waiting: list[pa.Table] = []
        self._waiting_rows = self._waiting_bytes = 0
        self._rows = 0
        self._file: BinaryIO | None = None
        self._writer: ParquetWriter | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            self._flush()
        self._end()

    def begin(self) -> int:
        """The number of the file that the next rows go to."""
        if self._file is not None and not self._waiting and self._file.tell() >= self.most_bytes:
            self._end()
        return len(self.shards)

    def write(self, parts: Iterable[pa.Table]) -> None:
        """Add rows, which stay together in one file."""
        self.begin()
        for part in parts:
            if part.num_rows:
                self._waiting.append(part)
                self._waiting_rows += part.num_rows
                self._waiting_bytes += part.nbytes
            if self._waiting_rows >= GROUP_ROWS or self._waiting_bytes >= GROUP_BYTES:
                self._flush()

    def _flush(self) -> None:
        """Write what waits as one row group."""
        if not self._waiting:
            return
        if self._writer is None:
            path = self.place(len(self.shards))
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("wb")
            self._writer = ParquetWriter(
                self._file,
                self.schema,
                compression="zstd",
                use_dictionary=_repeating(self.schema),
                dictionary_pagesize_limit=GROUP_BYTES,
            )
        group = pa.concat_tables(self._waiting)
        self._waiting, self._waiting_rows, self._waiting_bytes = [], 0, 0
        self._writer.write_table(group, row_group_size=max(1, group.num_rows))
        self._rows += group.num_rows

    def _end(self) -> None:
        if self._writer is not None and self._file is not None:
            self._writer.close()
            self._file.close()
            self.shards.append(Shard(self.place(len(self.shards)), self._rows))
        self._writer, self._file, self._rows = None, None, 0


def _repeating(schema: pa.Schema) -> list[str]:
    """Paths of columns in which one value may stand in many rows, as an image in many frames: it is written once."""
    found = []
    for field in schema:
        if pa.types.is_string(field.type):
            found.append(field.name)
        elif pa.types.is_list(field.type) and pa.types.is_string(field.type.value_type):
            found.append(f"{field.name}.list.element")
        elif pa.types.is_struct(field.type):
            found += [f"{field.name}.{part.name}" for part in field.type]
    return found
