"""Episodes in an archive: ``episodes.parquet``, a row for each line of their logs."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cache
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import UUID

from sqlalchemy import Connection, select

from palpate.store import schema
from palpate.store.embargo import Embargoes, embargo_stated, is_seen_as
from palpate.store.episodes import StoredEpisode, episode_from
from palpate.store.errors import DamagedError
from palpate.store.exporting.selection import Selection
from palpate.store.keeping_episodes import episodes_of
from palpate.store.records import ThingRef, visibility_now
from palpate.store.registry import now_us

if TYPE_CHECKING:
    import pyarrow

__all__ = ["EPISODES", "archived_episodes", "episodes_schema", "episodes_with", "write_episodes"]

EPISODES = "episodes.parquet"


@cache
def episodes_schema() -> pyarrow.Schema:
    """The columns of ``episodes.parquet``; the line of position 0 tells how the object was explored."""
    import pyarrow as pa

    texts = ("episode", "digest", "visibility", "dataset", "object", "action", "recording", "document")
    moments = ("started_at", pa.timestamp("us", tz="UTC"))
    return pa.schema([*((name, pa.string()) for name in texts), moments, ("position", pa.int64())])


def episodes_with(selection: Selection) -> list[int]:
    """Rows of the episodes that have recordings, all of them selected, and the visibility that was asked for, if any.

    Where all recordings are selected, so are all episodes.
    """
    episodes, steps = schema.episodes.c, schema.episode_steps.c
    asked = select(episodes.id).order_by(episodes.id)
    if not selection.is_all:
        linked = select(steps.episode_id).where(steps.recording_id.is_not(None))
        outside = linked.where(steps.recording_id.not_in(selection.rows()))
        asked = asked.where(episodes.id.in_(linked), episodes.id.not_in(outside))
    if selection.wanted.visibility is not None:
        asked = asked.where(is_seen_as(schema.episodes, selection.wanted.visibility, now_us()))
    return list(selection.connection.scalars(asked))


def write_episodes(connection: Connection, ids: Sequence[int], folder: Path) -> Embargoes:
    """Write the episodes of rows; those that are or were embargoed are given."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    found: dict[str, tuple[str, str]] = {}
    with ParquetWriter(folder / EPISODES, episodes_schema(), compression="zstd") as writer:
        for episode in episodes_of(connection, ids):
            writer.write_table(pa.Table.from_pylist(list(_rows(episode)), schema=episodes_schema()))
            found |= embargo_stated(episode)
    return found


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
        "visibility": visibility_now(episode.visibility, episode.embargoed_until),
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
