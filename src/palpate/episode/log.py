"""Logs of explorations: a line per step, written as soon as it is done, and read to draw and to replay it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, Literal

from palpate.episode.format import About, Episode, episode_of, header_record, step_record
from palpate.errors import LogError
from palpate.explore import Step
from palpate.inference.belief import Belief
from palpate.logfile import EPISODE_FORMAT, Line, read_lines, write_line

__all__ = ["EpisodeLog", "read_episode", "record_episode"]


class EpisodeLog:
    """Writes the log of an episode, each step as soon as it is done.

    Parameters
    ----------
    belief
        The belief at the start.

    Raises
    ------
    LogError
        The file cannot be written.

    Examples
    --------
    ::

        log = EpisodeLog("episode.jsonl", belief, About(object="banana_ycb"))
        for step in explore(belief, robot):
            log.write(step)
    """

    def __init__(self, path: str | Path, belief: Belief, about: About | None = None) -> None:
        self._path = Path(path)
        self._add("w", header_record(belief, about or About()))

    def write(self, step: Step) -> None:
        """Add a step; LogError if the file cannot be written any more."""
        self._add("a", step_record(step))

    def _add(self, mode: Literal["a", "w"], record: Mapping[str, Any]) -> None:
        try:
            with self._path.open(mode, encoding="utf-8") as file:
                write_line(file, record)
        except OSError as error:
            raise LogError(f"{self._path} cannot be written: {error.strerror or error}") from error


def record_episode(belief: Belief, steps: Iterable[Step], about: About | None = None) -> Episode:
    """Make the episode of an exploration in memory: the same as writing its log and reading it."""
    records = [header_record(belief, about or About()), *map(step_record, steps)]
    return episode_of([Line(f"record {number}", record) for number, record in enumerate(records, 1)])


def read_episode(path: str | Path) -> Episode:
    """Read the log of an episode.

    Raises
    ------
    LogError
        The file cannot be read, is no episode log, or a line is cut off or lacks something; the
        message names the file and the line.
    """
    return episode_of(read_lines(path, EPISODE_FORMAT))
