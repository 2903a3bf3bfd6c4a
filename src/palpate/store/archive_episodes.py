"""Episodes in an archive: ``episodes.parquet``, a row for each line of their logs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import UUID

from sqlalchemy import Connection

from palpate.store.episodes import StoredEpisode, episode_from
from palpate.store.errors import DamagedError
from palpate.store.keeping_episodes import all_episodes
from palpate.store.records import ThingRef

if TYPE_CHECKING:
    import pyarrow

__all__ = ["EPISODES", "archived_episodes", "episodes_schema", "write_episodes"]

EPISODES = "episodes.parquet"


@cache
def episodes_schema() -> pyarrow.Schema:
    """The columns of ``episodes.parquet``; the line of position 0 tells how the object was explored."""
    import pyarrow as pa

    texts = ("episode", "digest", "visibility", "dataset", "object", "action", "recording", "document")
    moments = ("started_at", pa.timestamp("us", tz="UTC"))
    return pa.schema([*((name, pa.string()) for name in texts), moments, ("position", pa.int64())])


def write_episodes(connection: Connection, folder: Path) -> int:
    """Write all episodes, and return how many they are."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    count = 0
    with ParquetWriter(folder / EPISODES, episodes_schema(), compression="zstd") as writer:
        for episode in all_episodes(connection):
            writer.write_table(pa.Table.from_pylist(list(_rows(episode)), schema=episodes_schema()))
            count += 1
    return count


def archived_episodes(rows: Iterable[Mapping[str, Any]]) -> Iterator[tuple[str, StoredEpisode | str]]:
    """Give the episodes of rows: under which id, and the episode, verified, or what is wrong with it."""
    for key, lines in groupby(rows, key=lambda row: str(row["episode"])):
        try:
            yield key, _episode(key, list(lines))
        except (ValueError, TypeError, KeyError) as error:
            yield key, str(error) if isinstance(error, DamagedError) else f"cannot be read ({error})"


def _rows(episode: StoredEpisode) -> Iterator[dict[str, Any]]:
    shared = {
        "episode": str(episode.id),
        "digest": episode.digest,
        "visibility": episode.visibility,
        "dataset": episode.thing.dataset,
        "object": episode.thing.id,
        "started_at": episode.started_at,
    }
    yield {**shared, "position": 0, "document": episode.document}
    for place, step in enumerate(episode.steps, 1):
        told = {"action": step.record.get("action"), "recording": step.recording, "document": step.document}
        yield {**shared, "position": place, **told}


def _episode(key: str, lines: Sequence[Any]) -> StoredEpisode:
    first, *steps = sorted(lines, key=lambda line: line["position"])
    thing = ThingRef(*json.loads(first["document"])["thing"])
    documents = [line["document"] for line in steps]
    return episode_from(
        first["document"], documents, first["digest"], thing=thing, visibility=first["visibility"], id=UUID(key)
    )
