"""Episodes in an archive: ``episodes.parquet``, a row for each line of their logs."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
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

__all__ = ["EPISODES", "read_episodes", "write_episodes"]

EPISODES = "episodes.parquet"


@cache
def episodes_schema() -> pyarrow.Schema:
    """The columns of ``episodes.parquet``; the line of position 0 tells how the object was explored."""
    import pyarrow as pa

    texts = ("episode", "digest", "visibility", "dataset", "object", "action", "recording", "document")
    moments = ("started_at", pa.timestamp("us", tz="UTC"))
    return pa.schema([*((name, pa.string()) for name in texts), moments, ("position", pa.int64())])


def write_episodes(connection: Connection, folder: Path) -> None:
    """Write all episodes."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    with ParquetWriter(folder / EPISODES, episodes_schema(), compression="zstd") as writer:
        for episode in all_episodes(connection):
            writer.write_table(pa.Table.from_pylist(list(_rows(episode)), schema=episodes_schema()))


def read_episodes(folder: Path) -> Iterator[StoredEpisode]:
    """Give the episodes of an archive, each one verified.

    Raises
    ------
    DamagedError
        If one is not what was written.
    """
    from pyarrow.parquet import ParquetFile

    batches = ParquetFile(folder / EPISODES).iter_batches(batch_size=1000)
    rows = (row for batch in batches for row in batch.to_pylist())
    for key, lines in groupby(rows, key=lambda row: row["episode"]):
        try:
            yield _episode(key, list(lines))
        except (ValueError, TypeError, KeyError) as error:
            if isinstance(error, DamagedError):
                raise
            raise DamagedError(f"{folder / EPISODES}: episode {key} cannot be read ({error})") from None


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
