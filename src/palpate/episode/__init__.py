"""Episodes: explorations kept, a line per step, in a log of their own or in a store with their recordings."""

from __future__ import annotations

from palpate.episode.format import About, Episode, LoggedStep
from palpate.episode.log import EpisodeLog, read_episode, record_episode

__all__ = ["About", "Episode", "EpisodeLog", "LoggedStep", "read_episode", "record_episode"]
