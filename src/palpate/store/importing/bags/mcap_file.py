"""MCAP files, from the first record to the last: without an index, as that of a recorder that was killed is missing."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

from palpate.store.errors import StoreError
from palpate.store.importing.bags.packets import LATEST_NS, Kind, Packet, translated
from palpate.store.importing.bags.unpacking import LARGEST_BYTES, unlz4, unzstd

if TYPE_CHECKING:
    from mcap.records import Chunk, McapRecord, Schema

__all__ = ["MAGIC", "McapFile"]

MAGIC = b"\x89MCAP0\r\n"
LARGEST_RECORD_BYTES = 1 << 30
NOTHING = "before the first message or in the middle of the first chunk of them, so that none can be read"
CUT = "a message, or a chunk of messages, that was being written is lost"


class McapFile:
    """A source of the messages of an MCAP file; for its attributes see `Source`.

    Parameters
    ----------
    is_packed
        Whether each message is compressed by zstd, as some ROS 2 recorders do.
    """

    def __init__(self, path: Path, *, is_packed: bool = False) -> None:
        self.path, self.is_packed = path, is_packed
        self.topics: set[str] = set()
        self.first_ns: int | None = None
        self.notices: list[str] = []

    def packets(self, wanted: Collection[str]) -> Iterator[Packet]:
        """Read the messages of the topics that are wanted, in the order of the file."""
        from mcap.exceptions import EndOfFile

        self.notices, messages = [], 0
        with translated(self.path.name, "a whole MCAP file"), self.path.open("rb") as file:
            size = self.path.stat().st_size
            if size >= len(MAGIC):
                file.seek(-len(MAGIC), 2)
            is_ended = file.read() == MAGIC
            file.seek(0)
            try:
                for packet in self._messages(Whole(file, size)):
                    messages += 1
                    if packet.kind.topic in wanted:
                        yield packet
            except EndOfFile as error:
                if is_ended or not messages:
                    found = "a record is longer than the file" if is_ended else f"ends after {size} bytes, {NOTHING}"
                    raise StoreError(f"{self.path.name}: {found}, expected a whole MCAP file") from error
                self.notices.append(
                    f"{self.path.name} ends in the middle, after {messages} messages that are kept: {CUT}"
                )

    def _messages(self, file: Whole) -> Iterator[Packet]:
        from mcap.records import Attachment, Channel, Message, Statistics
        from mcap.records import Schema as SchemaRecord

        schemas: dict[int, Schema] = {}
        kinds: dict[int, Kind] = {}
        messages = 0
        for record in self._records(file):
            if isinstance(record, Message):
                messages += 1
                data = unzstd(record.data, self.path.name) if self.is_packed else record.data
                if record.log_time > LATEST_NS:
                    raise StoreError(f"{self.path.name}: a message of {record.log_time} ns, expected ns since 1970")
                if record.channel_id not in kinds:
                    found = f"a message of channel {record.channel_id}"
                    raise StoreError(f"{self.path.name}: {found}, expected one that the file defines before it")
                if self.first_ns is None or record.log_time < self.first_ns:
                    self.first_ns = record.log_time
                yield Packet(kinds[record.channel_id], record.log_time, data)
            elif isinstance(record, SchemaRecord):
                schemas[record.id] = record
            elif isinstance(record, Channel):
                kinds[record.id] = _kind(record.topic, record.message_encoding, schemas.get(record.schema_id))
                self.topics.add(record.topic)
            elif isinstance(record, Statistics) and record.message_count != messages:
                # a chunk whose kind was changed is passed over without a word
                found = f"{messages} messages"
                raise StoreError(f"{self.path.name}: {found}, expected {record.message_count} as its statistics say")
            elif isinstance(record, Attachment):
                self.notices.append(f"the attachment {record.name!r} of {self.path.name} is not imported")

    def _records(self, file: Whole) -> Iterator[McapRecord]:
        """All records up to the end of the data, and those in chunks; what repeats them after it is left out."""
        from mcap.records import Chunk, DataEnd, Statistics
        from mcap.stream_reader import StreamReader

        is_data = True
        reader = StreamReader(
            cast("IO[bytes]", file), emit_chunks=True, validate_crcs=True, record_size_limit=LARGEST_RECORD_BYTES
        )
        for record in reader.records:
            is_data = is_data and not isinstance(record, DataEnd)
            if isinstance(record, Chunk):
                yield from self._in_chunk(record)
            elif is_data or isinstance(record, Statistics):
                yield record

    def _in_chunk(self, chunk: Chunk) -> list[McapRecord]:
        from mcap.exceptions import EndOfFile
        from mcap.stream_reader import breakup_chunk

        try:
            return breakup_chunk(self._unpacked(chunk), validate_crc=True)
        except EndOfFile as error:
            raise StoreError(f"{self.path.name}: a record is longer than its chunk, expected a whole one") from error

    def _unpacked(self, chunk: Chunk) -> Chunk:
        limit = min(chunk.uncompressed_size, LARGEST_BYTES)
        if chunk.compression not in ("", "zstd", "lz4"):
            raise StoreError(
                f"{self.path.name}: a chunk is compressed by {chunk.compression!r}, expected 'zstd', 'lz4' or nothing"
            )
        data = chunk.data
        if chunk.compression:
            data = (unzstd if chunk.compression == "zstd" else unlz4)(data, f"{self.path.name}: a chunk", limit)
        if len(data) != chunk.uncompressed_size:
            found = f"a chunk of {len(data)} bytes"
            raise StoreError(f"{self.path.name}: {found}, expected {chunk.uncompressed_size} as it says")
        return replace(chunk, compression="", data=data)


class Whole:
    """A file that gives all bytes that are asked for, or says that it has ended."""

    def __init__(self, file: IO[bytes], size: int) -> None:
        self._file, self._left = file, size

    def read(self, count: int) -> bytes:
        """Read exactly so many bytes."""
        from mcap.exceptions import EndOfFile

        if count > self._left:
            raise EndOfFile
        self._left -= count
        return self._file.read(count)


def _kind(topic: str, encoding: str, schema: Schema | None) -> Kind:
    if schema is None:
        return Kind(topic, "", encoding)
    return Kind(topic, schema.name, encoding, schema.encoding, schema.data.decode())
