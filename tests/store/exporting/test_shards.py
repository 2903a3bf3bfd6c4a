from collections.abc import Iterator
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from palpate.store.content import file_digest
from palpate.store.exporting import shards as module
from palpate.store.exporting.shards import ShardWriter

SCHEMA = pa.schema([("row", pa.int64()), ("data", pa.binary())])


def rows(first: int, count: int, size: int = 10) -> pa.Table:
    numbers = list(range(first, first + count))
    return pa.table({"row": numbers, "data": [bytes([number % 256]) * size for number in numbers]}, SCHEMA)


def test_a_table_is_split_into_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Another file begins when one is large, what is written together stays together, and no row is lost."""
    monkeypatch.setattr(module, "GROUP_ROWS", 5)
    with ShardWriter(SCHEMA, lambda number: tmp_path / f"{number}.parquet", most_bytes=1) as writer:
        places = []
        for first in range(0, 40, 8):
            places.append(writer.begin())
            writer.write([rows(first, 4), rows(first + 4, 4)])
    assert places == [0, 1, 2, 3, 4]
    tables = [pq.read_table(shard.path) for shard in writer.shards]
    assert [table["row"].to_pylist() for table in tables] == [
        list(range(first, first + 8)) for first in range(0, 40, 8)
    ]
    assert [shard.rows for shard in writer.shards] == [8] * 5
    assert writer.shards[0].sha256 == file_digest(tmp_path / "0.parquet")


def test_a_table_without_rows_is_no_file(tmp_path: Path) -> None:
    """Where nothing is written there is no file."""
    with ShardWriter(SCHEMA, lambda number: tmp_path / f"{number}.parquet") as writer:
        writer.write([rows(0, 0)])
    assert writer.shards == []
    assert not list(tmp_path.iterdir())


def test_what_waits_is_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Rows that are large are written soon, in groups of bounded size."""
    monkeypatch.setattr(module, "GROUP_BYTES", 10_000)
    with ShardWriter(SCHEMA, lambda number: tmp_path / f"{number}.parquet") as writer:
        writer.write(rows(number, 1, 4000) for number in range(9))
    groups = pq.ParquetFile(writer.shards[0].path)
    assert [groups.metadata.row_group(number).num_rows for number in range(groups.num_row_groups)] == [3, 3, 3]


def test_a_failure_closes_files(tmp_path: Path) -> None:
    """When writing fails its files are closed, with the rows that were written, and the error is the one raised."""

    def failing() -> Iterator[pa.Table]:
        yield rows(0, 3000)
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError), ShardWriter(SCHEMA, lambda number: tmp_path / "rows.parquet") as writer:
        writer.write(failing())
    assert pq.read_table(tmp_path / "rows.parquet").num_rows == 3000
