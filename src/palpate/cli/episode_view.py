"""Episodes of a store in the terminal, as JSON, and as logs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.cli.files import replacing
from palpate.cli.short_ids import shortened
from palpate.cli.terminal import folding_table
from palpate.episode.format import episode_of
from palpate.logfile import Line, write_line
from palpate.wording import number, outcome_words

if TYPE_CHECKING:
    from palpate.store.episodes import StoredEpisode
    from palpate.store.listing_episodes import EpisodePage

__all__ = ["episode_json", "episode_view", "episodes_json", "episodes_table", "write_log"]


def episodes_table(page: EpisodePage, *, whole: bool = True) -> Table:
    """A page of a list; ids whole, or as short as they can be told apart on it."""
    write = shortened((row.id for row in page.rows), whole=whole)
    table = folding_table("episode", "began (UTC)", "object", "actions", "stopped as", right=(3,))
    table.columns[0].no_wrap = True
    for row in page.rows:
        table.add_row(
            write(row.id),
            f"{row.started_at:%Y-%m-%d %H:%M}",
            row.common_name or row.thing,
            str(row.actions),
            row.stop or "it was interrupted",
        )
    return table


def episodes_json(page: EpisodePage) -> str:
    """A page of a list as JSON."""
    rows = [{**vars(row), "id": str(row.id), "started_at": row.started_at.isoformat()} for row in page.rows]
    return json.dumps({"episodes": rows, "cursor": page.cursor}, indent=1)


def episode_view(stored: StoredEpisode, *, whole: bool = True) -> RenderableType:
    """How an object was explored, and each step with its recording; digests whole, or as short as will do."""
    lines = [Line(f"episode {stored.id} line {place}", record) for place, record in enumerate(stored.records, 1)]
    episode = episode_of(lines)
    about = episode.about
    how = f"network {episode.network}, objective {about.objective}, policy {about.policy}, robot {about.robot}"
    names = ("step", "action", "outcome", "expected", "realised", "surprise", "time", "recording")
    table = folding_table(*names, right=(0, 3, 4, 5, 6))
    write = shortened((kept.recording for kept in stored.steps if kept.recording), whole=whole)
    for step, kept in zip(episode.steps, stored.steps, strict=False):
        table.add_row(
            str(step.index),
            step.action,
            outcome_words(step.outcome),
            number(step.expected_gain_bits),
            number(step.realised_gain_bits),
            number(step.surprise, 2),
            f"{step.total_cost_s:g} s",
            write(kept.recording) if kept.recording else "none",
        )
    head = f"{stored.thing.dataset}/{stored.thing.id}, {stored.started_at:%Y-%m-%d %H:%M:%S} UTC"
    end = f"stopped: {episode.stop}" if episode.stop is not None else "it was interrupted"
    return Group(Text(head, style="bold"), Text(how, style="dim"), table, Text(end))


def episode_json(stored: StoredEpisode) -> str:
    """The lines of an episode's log, with the digest of each recording."""
    steps = [{"record": step.record, "recording": step.recording} for step in stored.steps]
    head = {"id": str(stored.id), "digest": stored.digest, "started_at": stored.started_at.isoformat()}
    told = {"dataset": stored.thing.dataset, "object": stored.thing.id, "owner": stored.owner}
    return json.dumps({**head, **told, "header": stored.header, "steps": steps}, indent=1)


def write_log(stored: StoredEpisode, path: Path) -> None:
    """Write the log, which `palpate episode plot` draws and `palpate explore --session` replays."""
    with replacing(path) as draft, draft.open("w", encoding="utf-8") as file:
        for record in stored.records:
            write_line(file, record)
