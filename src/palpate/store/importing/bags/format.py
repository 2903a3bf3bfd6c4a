"""Bags among the formats that can be imported."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from palpate.store.importing.bags.bags import read_bag
from palpate.store.importing.bags.opening import is_bag
from palpate.store.importing.bags.topics import TopicMap
from palpate.store.importing.items import Fate, Item, Outcome
from palpate.store.records import Recording

__all__ = ["Bags"]

UNMAPPED = "is a bag, and nothing says what its topics become: give a map of topics with --topics FILE.toml"


class Bags:
    """ROS 2 bags and MCAP files.

    Parameters
    ----------
    topics
        What their topics become; without it they are skipped.
    """

    def __init__(self, topics: TopicMap | None = None) -> None:
        self.topics = topics

    def owns(self, path: Path) -> bool:
        """Tell whether it is a bag."""
        return is_bag(path)

    def count(self, path: Path) -> int:
        """As many as the map cuts; one where only the bag knows."""
        return len(self.topics.cuts) if self.topics and self.topics.cuts else 1

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """The recordings; a bag that is one is read when it is its turn, one of several at once."""
        topics = self.topics
        if topics is None:
            yield Outcome(str(path), Fate.SKIPPED, UNMAPPED)
        elif topics.cuts or topics.marker:
            for place, recording in enumerate(read_bag(path, topics), start=1):
                yield Item(f"{path}: recording {place}", partial(_same, recording), recording.digest)
        else:
            yield Item(str(path), partial(_only, path, topics))


def _only(path: Path, topics: TopicMap) -> Recording:
    (recording,) = read_bag(path, topics)
    return recording


def _same(recording: Recording) -> Recording:
    return recording
