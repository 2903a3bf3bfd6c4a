"""A data set in the layout of LeRobot: each recording is an episode."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from uuid import UUID

from palpate.errors import plural
from palpate.store.errors import StoreError
from palpate.store.exporting.citation import citation_file
from palpate.store.exporting.croissant import Described, croissant_file
from palpate.store.exporting.lerobot.card import card
from palpate.store.exporting.lerobot.episodes import (
    EPISODES,
    EpisodeWriter,
    chunked,
    episodes_schema,
    frames_table,
)
from palpate.store.exporting.lerobot.features import Features, all_untimed, find_features
from palpate.store.exporting.lerobot.frames import Timing
from palpate.store.exporting.lerobot.info import TASKS, robot_of, write_meta, write_tasks
from palpate.store.exporting.lerobot.resampling import Nearest, Resampling
from palpate.store.exporting.publication import Terms, publication
from palpate.store.exporting.selection import Selection
from palpate.store.exporting.shards import ShardWriter
from palpate.store.exporting.tables import withheld
from palpate.store.exporting.writing import Told, Written
from palpate.store.records import Recording

__all__ = ["LeRobot"]

DATA_MB = 100


@dataclass(frozen=True)
class LeRobot:
    """Recordings as episodes of evenly spaced frames, in the layout of LeRobot 3.0.

    The channels that all recordings have are the feature ``observation.state``, images that all have are features of
    their own and stay the same throughout an episode. There is no ``action``, as recordings hold what was measured and
    not what was commanded. What cannot be part of it is told.

    Attributes
    ----------
    terms
        Title, authors and licence.
    fps
        Frames per second.
    resampling
        What a channel is at the moment of a frame.
    assumed_rate_hz
        Samples per second [Hz] of channels that state neither a rate nor time stamps; they are left out where None.
    data_mb
        A file of frames that is so large [MB] is followed by another.
    """

    terms: Terms = field(default_factory=Terms)
    fps: int = 30
    resampling: Resampling = field(default_factory=Nearest)
    assumed_rate_hz: float | None = None
    data_mb: int = DATA_MB

    @property
    def _timing(self) -> Timing:
        return Timing(self.fps, self.resampling, self.assumed_rate_hz)

    def _lacking(self, given: Selection) -> Mapping[str, str]:
        untimed = None if self.assumed_rate_hz is not None else all_untimed(given)
        return {} if untimed is None else {"assumed_rate_hz": untimed}

    def write(self, selection: Selection, folder: Path, told: Told) -> Written:
        """Write frames, what describes them, and the card.

        Raises
        ------
        StoreError
            If no recording can be an episode.
        """
        given, data = publication(selection, self.terms, self._lacking)
        features = find_features(given, self.assumed_rate_hz)
        episodes, notices = self._write_episodes(given, features, folder, told, data.census.recordings)
        if not episodes.episodes:
            raise StoreError(f"export: no recording can be an episode ({notices[0]}), expected one at least")
        write_meta(folder / "meta", episodes, self.data_mb, robot_of(data.census))
        described = [
            Described(episodes.table, episodes.data.shards),
            Described(EPISODES, episodes.meta.shards),
            Described(TASKS, [write_tasks(folder / "meta", episodes.tasks)]),
        ]
        (folder / "croissant.json").write_text(croissant_file(data, described, folder), encoding="utf-8")
        (folder / "CITATION.cff").write_text(citation_file(data), encoding="utf-8")
        said, private = (*features.notices, *notices), withheld(selection, data)
        told_of = (f"{plural(private, 'recording')} left out, not public", *said) if private else said
        (folder / "README.md").write_text(
            card(data, [one.table for one in described], episodes, told_of), encoding="utf-8"
        )
        return Written(episodes.episodes, said, private)

    def _write_episodes(
        self, selection: Selection, features: Features, folder: Path, told: Told, of: int
    ) -> tuple[EpisodeWriter, list[str]]:
        """Write all that can be episodes, and say why others cannot."""
        table, refused, done = frames_table(features), Refused(), 0
        with ExitStack() as stack:
            data, meta = (
                stack.enter_context(ShardWriter(schema, partial(chunked, folder / name), self.data_mb << 20))
                for name, schema in (("data", table.schema), ("meta/episodes", episodes_schema(table)))
            )
            episodes = EpisodeWriter(features, self._timing, data, meta)
            for batch in selection.batches():
                for recording in batch:
                    try:
                        episodes.write(recording)
                    except StoreError as error:
                        refused.add(recording, str(error))
                done += len(batch)
                told(done, of)
            episodes.finish()
        return episodes, refused.notices()


class Refused:
    """Recordings that are no episodes, by the reason why: the first of each, and how many."""

    def __init__(self) -> None:
        self._first: dict[str, UUID] = {}
        self._counts: Counter[str] = Counter()

    def add(self, recording: Recording, reason: str) -> None:
        """Note one."""
        self._first.setdefault(reason, recording.id)
        self._counts[reason] += 1

    def notices(self) -> list[str]:
        """One sentence for each reason."""
        return [
            f"{plural(count, 'recording')} left out, {reason} (the first: {self._first[reason]})"
            for reason, count in self._counts.most_common()
        ]
