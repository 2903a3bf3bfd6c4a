import sqlite3
from contextlib import closing
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import CompressionMode

from palpate.store.errors import StoreError
from palpate.store.importing.bags import opening as module
from palpate.store.importing.bags import read_bag
from palpate.store.importing.bags.metadata import read_metadata
from palpate.store.importing.bags.unpacking import unzstd_file
from tests.store.importing.bags.made import ns, number, topic_map, write_bag

NUMBERS: list[Any] = [("/n", ns(i), number(i)) for i in range(5)]
MAP = '[topics."/n".series.s]\nx = {field = "data"}\n'


def changed(bag: Path, old: str, new: str) -> Path:
    """The bag with other words in its metadata."""
    metadata = bag / "metadata.yaml"
    assert old in metadata.read_text()
    metadata.write_text(metadata.read_text().replace(old, new))
    return bag


@pytest.mark.parametrize(
    "name", ["../secret.db3", "/etc/passwd", "C:\\\\secret.db3", "..\\\\secret.db3", "link.db3", "folder/secret.db3"]
)
def test_files_outside_the_bag_are_never_read(tmp_path: Path, name: str) -> None:
    """A path that leads out of the folder, or a link that does, is refused."""
    outside = write_bag(tmp_path / "secret", NUMBERS) / "secret.db3"
    (tmp_path / "secret.db3").write_bytes(outside.read_bytes())
    bag = changed(write_bag(tmp_path / "bag", NUMBERS), "- bag.db3", f'- "{name}"')
    (bag / "link.db3").symlink_to(outside)
    (bag / "folder").symlink_to(tmp_path)
    with pytest.raises(StoreError, match=r"bag: metadata\.yaml: relative_file_paths: .* expected .* inside"):
        read_bag(bag, topic_map(tmp_path, MAP))


def test_paths_from_beside_the_folder_are_understood(tmp_path: Path) -> None:
    """The first versions of the format gave paths that begin with the folder's own name."""
    bag = changed(write_bag(tmp_path / "bag", NUMBERS), "- bag.db3", "- bag/bag.db3")
    (found,) = read_bag(bag, topic_map(tmp_path, MAP))
    assert len(found.series[0].channels[0].values) == 5


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("storage_identifier: sqlite3", "storage_identifier: tape", "'tape'; choose from 'mcap', 'sqlite3'"),
        ("- bag.db3", "- other.db3", "there is no file 'other.db3'"),
        ("- bag.db3", "[]", "relative_file_paths is no list"),
        ("rosbag2_bagfile_information:", "something_else:", "found no table 'rosbag2_bagfile_information'"),
        ("version:", "version: [", "is no readable YAML"),
    ],
)
def test_metadata_that_are_wrong_are_refused(tmp_path: Path, old: str, new: str, told: str) -> None:
    """Another storage, a file that is not there, and what is no YAML, are one sentence."""
    bag = changed(write_bag(tmp_path / "bag", NUMBERS), old, new)
    if new == "[]":
        changed(bag, "relative_file_paths:\n  []", "relative_file_paths: []")
    with pytest.raises(StoreError, match=told):
        read_metadata(bag)


def test_other_compression_is_refused(tmp_path: Path) -> None:
    """A way of compression that is not zstd is refused by its name."""
    bag = write_bag(tmp_path / "bag", NUMBERS, compression=CompressionMode.FILE)
    changed(bag, "compression_format: zstd", "compression_format: lzma")
    with pytest.raises(StoreError, match="compression by 'lzma' of each file is not supported"):
        read_metadata(bag)


def test_a_folder_of_aliases_stays_small(tmp_path: Path) -> None:
    """Aliases of aliases, which stand for billions of words, are read in no time and refused."""
    lines = ["a0: &a0 [x, x]", *(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]" for i in range(1, 40))]
    lines += ["rosbag2_bagfile_information: {storage_identifier: sqlite3, relative_file_paths: *a39}"]
    (tmp_path / "metadata.yaml").write_text("\n".join(lines))
    with pytest.raises(StoreError, match="relative_file_paths is no list of names"):
        read_metadata(tmp_path)


def test_metadata_that_are_too_large_are_refused(tmp_path: Path) -> None:
    """A file that cannot be metadata is not read at all."""
    (tmp_path / "metadata.yaml").write_bytes(b"rosbag2_bagfile_information" + bytes(9 << 20))
    with pytest.raises(StoreError, match="8388608 at most"):
        read_metadata(tmp_path)


def test_a_packed_file_has_a_limit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A file of a bag that unpacks to more than the limit is refused."""
    monkeypatch.setattr(module, "unzstd_file", lambda packed, unpacked: unzstd_file(packed, unpacked, 1000))
    bag = write_bag(tmp_path / "bag", NUMBERS, compression=CompressionMode.FILE)
    with pytest.raises(StoreError, match=r"bag\.db3\.zstd: more than 1000 bytes when it is unpacked"):
        read_bag(bag, topic_map(tmp_path, MAP))


@pytest.mark.parametrize("mode", [CompressionMode.FILE, CompressionMode.MESSAGE])
@given(st.integers(0, 10**6), st.integers(1, 255))
@settings(max_examples=25)
def test_damage_to_a_bag_is_one_sentence(mode: CompressionMode, place: int, change: int) -> None:
    """A changed byte anywhere in a folder's files is a StoreError, or a recording."""
    with TemporaryDirectory() as name:
        bag = write_bag(Path(name) / "bag", NUMBERS, compression=mode)
        for file in sorted(bag.iterdir()):
            content = bytearray(file.read_bytes())
            content[place % len(content)] ^= change
            file.write_bytes(content)
            try:
                found = read_bag(bag, topic_map(Path(name), MAP))
            except StoreError as error:
                assert str(error).startswith(str(bag))  # noqa: PT017
            else:
                assert len(found) == 1


def test_a_message_that_unpacks_to_too_much_is_refused(tmp_path: Path) -> None:
    """A message that is compressed by itself has a limit too."""
    bag = write_bag(tmp_path / "bag", NUMBERS, compression=CompressionMode.MESSAGE)
    with closing(sqlite3.connect(bag / "bag.db3")) as connection, connection:
        connection.execute("UPDATE messages SET data = ? WHERE id = 3", (zstandard.compress(bytes(300 << 20)),))
    with pytest.raises(StoreError, match="more than 268435456 bytes"):
        read_bag(bag, topic_map(tmp_path, MAP))
