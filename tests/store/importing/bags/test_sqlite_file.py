import sqlite3
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from tests.store.importing.bags.made import ns, number, topic_map, write_bag

NUMBERS: list[Any] = [("/n", ns(i), number(i)) for i in range(5)]
MAP = '[topics."/n".series.s]\nx = {field = "data"}\n'


def change(folder: Path, *statements: str) -> Path:
    """The file of a bag after some statements."""
    file = write_bag(folder, NUMBERS) / f"{folder.name}.db3"
    with closing(sqlite3.connect(file)) as connection, connection:
        for statement in statements:
            connection.execute(statement)
    return file


@pytest.mark.parametrize(
    ("statements", "told"),
    [
        (["DROP TABLE topics"], "has no tables topics and messages"),
        (["ALTER TABLE topics DROP COLUMN type"], "no such column: type"),
        (["UPDATE messages SET data = 'text' WHERE id = 2"], "a message of /n at .* with str"),
        (["UPDATE messages SET timestamp = -1 WHERE id = 2"], "at -1 with bytes, expected ns since 1970"),
        (["UPDATE messages SET timestamp = 'now' WHERE id = 2"], "at 'now'"),
        (["UPDATE messages SET data = x'00010000' WHERE id = 2"], "/n: a message cannot be read: .* expected one of"),
        (["UPDATE topics SET serialization_format = 'protobuf'"], "encoded as 'protobuf'"),
        (["DELETE FROM messages"], "holds no message"),
        (
            [
                "DROP TABLE messages",
                "CREATE VIEW messages AS WITH RECURSIVE n(id, topic_id, timestamp, data) AS "
                "(VALUES (1, 1, 1, x'00') UNION ALL SELECT id + 1, 1, 1, x'00' FROM n) SELECT * FROM n",
            ],
            "has no tables topics and messages",
        ),
    ],
)
def test_what_is_no_bag_is_refused(tmp_path: Path, statements: list[str], told: str) -> None:
    """A database with other tables, columns or values is one sentence; a view without end is never asked."""
    with pytest.raises(StoreError, match=told):
        read_bag(change(tmp_path / "bag", *statements), topic_map(tmp_path, MAP))


def test_names_of_folders_may_hold_any_letter(tmp_path: Path) -> None:
    """A bag is found whatever its folder is called."""
    folder = write_bag(tmp_path / "bag", NUMBERS).rename(tmp_path / "squeeze #3, 50% ä?mode=rw")
    (found,) = read_bag(folder, topic_map(tmp_path, MAP))
    assert found.series[0].channels[0].values.tolist() == [0, 1, 2, 3, 4]


def test_a_bag_is_not_changed(tmp_path: Path) -> None:
    """Reading leaves the folder as it was, to the byte."""
    bag = write_bag(tmp_path / "bag", NUMBERS)
    before = {file.name: file.read_bytes() for file in bag.iterdir()}
    read_bag(bag, topic_map(tmp_path, MAP))
    assert {file.name: file.read_bytes() for file in bag.iterdir()} == before


def test_what_a_killed_recorder_left_beside_is_read(tmp_path: Path) -> None:
    """Messages that are still in the write-ahead log of a recorder that was killed are read too."""
    file = write_bag(tmp_path / "bag", NUMBERS) / "bag.db3"
    connection = sqlite3.connect(file)
    connection.execute("PRAGMA journal_mode = WAL")
    with connection:
        connection.execute(
            "INSERT INTO messages (topic_id, timestamp, data) SELECT topic_id, timestamp + 1, data FROM messages"
        )
    left = tmp_path / "left.db3"
    for end in ("", "-wal"):
        Path(f"{left}{end}").write_bytes(Path(f"{file}{end}").read_bytes())
    connection.close()
    (found,) = read_bag(left, topic_map(tmp_path, MAP))
    assert len(found.series[0].channels[0].values) == 10


@given(st.lists(st.tuples(st.integers(0, 10**6), st.binary(min_size=1, max_size=8)), min_size=1, max_size=4))
@settings(max_examples=60)
def test_damage_is_one_sentence(changes: list[tuple[int, bytes]]) -> None:
    """Bytes written over a file are a StoreError, or a recording."""
    with TemporaryDirectory() as name:
        file = change(Path(name) / "bag")
        content = bytearray(file.read_bytes())
        for place, junk in changes:
            start = place % len(content)
            content[start : start + len(junk)] = junk[: len(content) - start]
        file.write_bytes(content[: changes[0][0]] if changes[0][0] % 3 == 0 else content)
        try:
            found = read_bag(file, topic_map(Path(name), MAP))
        except StoreError as error:
            assert str(error).startswith(str(file))  # noqa: PT017
        else:
            assert len(found) == 1
