import struct
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from zlib import crc32

import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

from palpate.store.errors import StoreError
from palpate.store.importing.bags import TopicMap, read_bag, read_topic_map
from palpate.store.importing.bags.mcap_file import MAGIC
from tests.store.importing.bags.made import HEAD, Written, ns, number, topic_map, write_mcap

NUMBERS: list[Written] = [("/n", ns(i), number(i)) for i in range(200)]
MAP = '[topics."/n".series.s]\nx = {field = "data"}\n'


def values(path: Path, topics: TopicMap) -> tuple[list[float], tuple[str, ...]]:
    (found,) = read_bag(path, topics)
    return found.series[0].channels[0].values.tolist(), found.notices


@pytest.mark.parametrize("compression", ["ZSTD", "LZ4", "NONE"])
@pytest.mark.parametrize("share", [0.3, 0.5, 0.9])
def test_a_file_that_was_cut_is_read_up_to_there(tmp_path: Path, compression: str, share: float) -> None:
    """What was written before the end of a file without footer is kept, and it is told that there is none."""
    whole = write_mcap(tmp_path / "whole.mcap", NUMBERS, compression, chunk_size=400).read_bytes()
    (tmp_path / "cut.mcap").write_bytes(whole[: int(len(whole) * share)])
    found, notices = values(tmp_path / "cut.mcap", topic_map(tmp_path, MAP))
    assert found == list(range(len(found)))
    assert 10 < len(found) <= 200
    (told,) = notices
    assert told.startswith(
        f"cut.mcap ends in the middle, after {len(found)} messages that are kept: a message, or a chunk"
    )


def test_a_file_that_was_cut_in_its_first_chunk_is_refused(tmp_path: Path) -> None:
    """Of a chunk that is not whole no message can be read; the sentence says so, and names the file once."""
    whole = write_mcap(tmp_path / "whole.mcap", NUMBERS, "ZSTD", chunk_size=1 << 20).read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[:500])
    with pytest.raises(StoreError, match="in the middle of the first chunk of them, so that none can be read") as told:
        read_bag(cut, topic_map(tmp_path, MAP))
    assert str(told.value).startswith(f"{cut}: ends after 500 bytes")


@given(st.data())
@settings(max_examples=40)
def test_any_cut_gives_the_beginning_or_one_sentence(data: st.DataObject) -> None:
    """Wherever a file is cut, the messages before the cut come out, or it is refused."""
    compression = data.draw(st.sampled_from(["ZSTD", "NONE"]))
    with TemporaryDirectory() as name:
        whole = write_mcap(Path(name) / "bag.mcap", NUMBERS, compression, chunk_size=400)
        content = whole.read_bytes()
        whole.write_bytes(content[: data.draw(st.integers(0, len(content) - 1))])
        topics = topic_map(Path(name), MAP)
        try:
            found, notices = values(whole, topics)
        except StoreError as error:
            found, notices = [], (str(error),)
    assert found == list(range(len(found)))
    assert len(notices) == 1


@given(st.lists(st.tuples(st.integers(0, 10**6), st.binary(min_size=1, max_size=8)), min_size=1, max_size=3))
@settings(max_examples=80)
def test_damage_is_found(changes: list[tuple[int, bytes]]) -> None:
    """Bytes written over a file with checksums are one sentence, or change nothing that is read."""
    with TemporaryDirectory() as name:
        bag = write_mcap(Path(name) / "bag.mcap", NUMBERS, chunk_size=400)
        content = bytearray(bag.read_bytes())
        for place, junk in changes:
            start = place % len(content)
            content[start : start + len(junk)] = junk[: len(content) - start]
        bag.write_bytes(content)
        try:
            found, _ = values(bag, topic_map(Path(name), MAP))
        except StoreError as error:
            assert str(error).startswith(str(bag))  # noqa: PT017
        else:
            assert found == list(range(len(found)))


@pytest.mark.parametrize("content", [b"", b"\x89MCAP", MAGIC, b"no bag at all" * 9, MAGIC + bytes(50), MAGIC * 5])
def test_what_is_no_mcap_file_is_refused(tmp_path: Path, content: bytes) -> None:
    """A file of that name with something else in it is one sentence."""
    (tmp_path / "bag.mcap").write_bytes(content)
    with pytest.raises(StoreError, match=r"bag\.mcap: .*expected"):
        read_bag(tmp_path / "bag.mcap", topic_map(tmp_path, MAP))


def chunked(compression: str, size: int, data: bytes, crc: int = 0) -> bytes:
    """A file of one chunk, which says what it likes of itself."""
    name = compression.encode()
    chunk = struct.pack("<QQQI", 0, 0, size, crc) + struct.pack("<I", len(name)) + name
    chunk += struct.pack("<Q", len(data)) + data
    head = struct.pack("<II", 0, 0)
    records = ((1, head), (6, chunk), (15, bytes(4)), (2, bytes(20)))
    return MAGIC + b"".join(struct.pack("<BQ", code, len(record)) + record for code, record in records) + MAGIC


BOMB = zstandard.compress(bytes(300 << 20))


@pytest.mark.parametrize(
    ("file", "told"),
    [
        (chunked("zstd", 300 << 20, BOMB), "a chunk: more than 268435456 bytes when it is unpacked"),
        (chunked("zstd", 10, BOMB), "a chunk: more than 10 bytes when it is unpacked"),
        (chunked("zstd", 1 << 60, BOMB[:100]), "cannot be unpacked"),
        (chunked("", 10, b"123"), "a chunk of 3 bytes, expected 10 as it says"),
        (chunked("snappy", 3, b"123"), "compressed by 'snappy', expected 'zstd', 'lz4' or nothing"),
        (chunked("", 9, b"\5" + struct.pack("<Q", 50)), "a record is longer than its chunk"),
        (chunked("", 3, b"123", crc32(b"124")), "crc validation failed"),
        (chunked("", 31, b"\5" + struct.pack("<QHIQQ", 22, 7, 0, 0, 0)), "a message of channel 7, expected one"),
        (MAGIC + struct.pack("<BQ", 1, 1 << 50) + MAGIC, "exceeds limit"),
        (MAGIC + struct.pack("<BQ", 1, 1 << 29) + MAGIC, "a record is longer than the file"),
    ],
)
def test_a_file_that_lies_is_refused(tmp_path: Path, file: bytes, told: str) -> None:
    """Sizes that are not true, bombs among them, are refused without unpacking more than the limit."""
    (tmp_path / "bag.mcap").write_bytes(file)
    with pytest.raises(StoreError, match=told):
        read_bag(tmp_path / "bag.mcap", topic_map(tmp_path, MAP))


def test_attachments_are_told(tmp_path: Path) -> None:
    """An attachment of the file is not imported, and that is a notice."""
    file = BytesIO()
    writer = McapWriter(file, compression=CompressionType.NONE)
    writer.start("", "")
    writer.add_attachment(0, 0, "calibration.yaml", "text/yaml", b"x: 1")
    channel = writer.register_channel("/n", "json", 0)
    writer.add_message(channel, ns(0), b'{"data": 1}', ns(0))
    writer.finish()
    (tmp_path / "bag.mcap").write_bytes(file.getvalue())
    (tmp_path / "map.toml").write_text(HEAD + MAP)
    _, notices = values(tmp_path / "bag.mcap", read_topic_map(tmp_path / "map.toml"))
    assert notices == ("the attachment 'calibration.yaml' of bag.mcap is not imported",)


def test_times_that_cannot_be_are_refused(tmp_path: Path) -> None:
    """A message of the far future comes from damage."""
    file = BytesIO()
    writer = McapWriter(file)
    writer.start("", "")
    writer.add_message(writer.register_channel("/n", "json", 0), 1 << 63, b"{}", 0)
    writer.finish()
    (tmp_path / "bag.mcap").write_bytes(file.getvalue())
    with pytest.raises(StoreError, match="expected ns since 1970"):
        read_bag(tmp_path / "bag.mcap", topic_map(tmp_path, MAP))
