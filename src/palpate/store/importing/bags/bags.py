"""Recordings from ROS 2 bags and MCAP files, by a map of topics."""

from __future__ import annotations

from pathlib import Path

from palpate.store.checks import check
from palpate.store.errors import StoreError
from palpate.store.importing.bags.files import Spill
from palpate.store.importing.bags.making import Making
from palpate.store.importing.bags.opening import opened_bag
from palpate.store.importing.bags.reading import Reading
from palpate.store.importing.bags.topics import TopicMap
from palpate.store.importing.items import identified
from palpate.store.records import Recording

__all__ = ["read_bag"]


def read_bag(path: str | Path, topics: TopicMap, *, folder: Path | None = None) -> tuple[Recording, ...]:
    """Read a bag; the same bag and map always give the same recordings, under the same ids.

    Only messages of the topics in the map are decoded, one by one, and what stays of them is what becomes part of a
    recording. What had to be decided on the way are notices of the recordings.

    Parameters
    ----------
    path
        The folder of a ROS 2 bag (with SQLite or MCAP files), a single file of one, an MCAP file with messages in CDR
        or JSON, or a ``.bag`` of ROS 1.
    topics
        What its messages become.
    folder
        An empty folder, where images and other files are until a store has taken the recordings; in memory unless
        given.

    Returns
    -------
    tuple
        One recording, or as many as the map says that there are in a bag.

    Raises
    ------
    StoreError
        If the bag is damaged, holds something else than the map says, or is encoded in a way that is not supported.
        An MCAP file that ends in the middle is read up to there, and that is noticed.
    """
    path = Path(path)
    try:
        with opened_bag(path) as bag:
            reading = Reading(bag, topics)
            making = Making(topics, reading, Spill(folder))
            return tuple(_checked(recording) for recording in making.recordings())
    except StoreError as error:
        # a bag of a single file has named it already
        raise StoreError(f"{path}: {str(error).removeprefix(f'{path.name}: ')}") from error
    except OSError as error:
        raise StoreError(f"{path}: cannot be read: {error.strerror or error}") from error


def _checked(recording: Recording) -> Recording:
    check(recording)
    return identified(recording)
