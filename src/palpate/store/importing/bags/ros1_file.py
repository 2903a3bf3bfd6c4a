"""The bags of ROS 1."""

from __future__ import annotations

import bz2
from collections.abc import Callable, Collection, Iterator
from functools import partial
from pathlib import Path

from palpate.store.importing.bags.packets import Kind, Packet, translated
from palpate.store.importing.bags.unpacking import unbz2, unlz4

__all__ = ["MAGIC", "Ros1File"]

MAGIC = b"#ROSBAG V2.0"


class Ros1File:
    """A source of the messages of a ``.bag`` file; for its attributes see `Source`."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.topics: set[str] = set()
        self.first_ns: int | None = None
        self.notices: list[str] = []

    def packets(self, wanted: Collection[str]) -> Iterator[Packet]:
        """Read the messages of the topics that are wanted, in the order of their times."""
        from rosbags.rosbag1 import Reader

        with translated(self.path.name, "a whole bag of ROS 1, as `rosbag reindex` makes it"), Reader(self.path) as bag:
            bag.chunks = {
                place: chunk._replace(decompressor=self._limited(chunk.decompressor))
                for place, chunk in bag.chunks.items()
            }
            self.topics |= {connection.topic for connection in bag.connections}
            self.first_ns = bag.start_time if bag.message_count else None
            kinds = {
                connection.id: Kind(connection.topic, connection.msgtype, "ros1", "ros1msg", connection.msgdef.data)
                for connection in bag.connections
            }
            chosen = [connection for connection in bag.connections if connection.topic in wanted]
            for connection, log_ns, data in bag.messages(chosen) if chosen else ():
                yield Packet(kinds[connection.id], log_ns, bytes(data))

    def _limited(self, decompressor: Callable[[bytes], bytes]) -> Callable[[bytes], bytes]:
        """The same decompression with a limit."""
        import lz4.frame  # type: ignore[import-untyped]

        where = f"{self.path.name}: a chunk"
        limited = {bz2.decompress: partial(unbz2, where=where), lz4.frame.decompress: partial(unlz4, where=where)}
        return limited.get(decompressor, decompressor)
