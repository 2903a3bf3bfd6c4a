"""Messages as they stand in the files of a bag: not yet decoded."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple, Protocol

from palpate.store.errors import StoreError

__all__ = ["LATEST_NS", "Kind", "Packet", "Source", "translated"]

LATEST_NS = 1 << 62
"""Times beyond this one, in the year 2116, come from damage."""


@dataclass(frozen=True)
class Kind:
    """What the messages of a topic are: their type, how they are encoded, and the definition of the type.

    `language` is that of the definition, such as ``ros2msg``; both are empty where the bag has none.
    """

    topic: str
    type: str
    encoding: str
    language: str = ""
    definition: str = ""


class Packet(NamedTuple):
    """One message, and when it was written [ns since 1970]."""

    kind: Kind
    log_ns: int
    data: bytes


class Source(Protocol):
    """One file of a bag; it can be read several times, and is not held in memory."""

    topics: set[str]
    """Names of all topics that were met so far."""

    first_ns: int | None
    """When the first message of any topic was written, once the packets were read."""

    notices: list[str]
    """What was odd about the file, once the packets were read."""

    def packets(self, wanted: Collection[str]) -> Iterator[Packet]:
        """Read the messages of the topics that are wanted.

        Raises
        ------
        StoreError
            If the file is damaged; the message says where.
        """


@contextmanager
def translated(where: str, expected: str) -> Iterator[None]:
    """Make whatever the readers of damaged bytes raise a StoreError; they have many words for it."""
    from mcap.exceptions import McapError
    from rosbags.rosbag1 import ReaderError
    from rosbags.serde import SerdeError
    from rosbags.typesys import TypesysError

    try:
        yield
    except StoreError:
        raise
    except (
        *(McapError, ReaderError, SerdeError, TypesysError),
        *(ArithmeticError, AssertionError, AttributeError, EOFError, LookupError, MemoryError),
        *(NameError, RuntimeError, SyntaxError, TypeError, ValueError),
    ) as error:
        told = " ".join(str(error).split())[:200] or type(error).__name__
        raise StoreError(f"{where}: {told}; expected {expected}") from error
