"""The card of a data set in the layout of LeRobot."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.errors import plural
from palpate.markdown import cell
from palpate.store.exporting.card import contents_part, front_matter, measured_part, quoting_part
from palpate.store.exporting.columns import Table
from palpate.store.exporting.lerobot.episodes import EpisodeWriter
from palpate.store.exporting.publication import Publication

__all__ = ["card"]

MOST_NOTICES = 50


def card(data: Publication, tables: Sequence[Table], episodes: EpisodeWriter, notices: Sequence[str]) -> str:
    """The text of ``README.md``.

    Parameters
    ----------
    data
        What was exported.
    tables
        Frames, episodes and tasks.
    episodes
        What was written.
    notices
        What was left out.
    """
    rows = (episodes.frames, episodes.episodes, len(episodes.tasks))
    parts = [
        front_matter(data, episodes.frames, ["LeRobot"], {"default": "data/*/*.parquet"}),
        f"# {cell(data.title)}",
        _rule(data, episodes),
        _left_out(notices),
        measured_part(data),
        contents_part(dict(zip(tables, rows, strict=True))),
        quoting_part(data),
    ]
    return "\n\n".join(part for part in parts if part) + "\n"


def _rule(data: Publication, episodes: EpisodeWriter) -> str:
    """How recordings became frames."""
    timing, features = episodes.timing, episodes.features
    text = [
        f"In the layout of LeRobot 3.0: {plural(episodes.episodes, 'episode')} with "
        f"{plural(episodes.frames, 'frame')} at {timing.fps} frames per second, of "
        f"{plural(data.census.recordings, 'recording')}."
    ]
    if features.signals:
        text.append(
            "The state is made of all channels that every recording has, as numbers of 32 bits. An episode lasts from "
            "when all of them have begun to when the first ends. In a frame a channel is "
            f"{timing.resampling.words}; samples that are not finite are passed over."
        )
    if timing.assumed_rate_hz is not None:
        text.append(f"Where neither a rate nor time stamps were stated, {timing.assumed_rate_hz:g} Hz is assumed.")
    if features.pictures:
        text.append("An image is the same in all frames of its episode.")
    return " ".join(text)


def _left_out(notices: Sequence[str]) -> str:
    if not notices:
        return ""
    lines = [f"- {cell(notice)}" for notice in notices[:MOST_NOTICES]]
    if len(notices) > MOST_NOTICES:
        lines.append(f"- and {len(notices) - MOST_NOTICES} more")
    return "\n".join(["## What was left out", "", *lines])
