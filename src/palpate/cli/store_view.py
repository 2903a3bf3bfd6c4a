"""A store and its recordings in the terminal."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.cli.short_ids import shortened
from palpate.cli.terminal import bullets, folding_table
from palpate.store.content import entry_plain
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.listing import Damaged, Listed, Page, list_recordings
from palpate.store.overview import Contents, contents
from palpate.wording import number, plural

if TYPE_CHECKING:
    from palpate.store.store import Store

__all__ = ["entry_words", "overview", "page_json", "page_table", "tell_next"]

SHOWN = 20


def entry_words(entry: Entry, most: int = 2) -> str:
    """A result in few words.

    Parameters
    ----------
    most
        So many labels of a distribution are named, the most probable ones.

    Examples
    --------
    >>> entry_words(Value("mass", 118.0, 6.0, "g"))
    'mass 118 ± 6.00 g'
    >>> entry_words(Distribution("category", {"mug": 0.9, "box": 0.1}))
    'category mug 0.90, box 0.10'
    >>> entry_words(Bound("elasticity", above=95.0, unit="kPa"))
    'elasticity above 95.0 kPa'
    """
    match entry:
        case Value(name, value, sd, unit):
            spread = "" if sd is None else f" ± {number(sd)}"
            return f"{name} {number(value)}{spread} {unit or '(unit not stated)'}"
        case Distribution(name, probabilities):
            return f"{name} {_top(probabilities, most)}"
        case Interval(name, low, high, unit):
            return f"{name} {number(low)} to {number(high)} {unit or '(unit not stated)'}"
        case Bound(name, above, below, unit):
            end = f"above {number(above)}" if above is not None else f"below {number(below)}"
            return f"{name} {end} {unit or '(unit not stated)'}"
        case FailedEntry(reason, name):
            return f"{name or 'all'} failed: {reason}"


def overview(store: Store, damaged: Damaged, *, whole: bool = True) -> RenderableType:
    """Objects, setups, and the last recordings with their notices; ids whole, or as short as will do.

    `damaged` is told of recordings and objects that are left out.
    """
    page, found = list_recordings(store, limit=SHOWN, damaged=damaged), contents(store, damaged)
    head = f"{plural(found.recordings, 'recording')} of {plural(len(found.things), 'object')}"
    if found.episodes:
        head += f" and {plural(found.episodes, 'episode')}"
    parts: list[RenderableType] = [Text(f"{head} in {store.engine.url!r}", overflow="fold")]
    if found.recordings:
        for part in (_things(found), _setups(found, whole=whole), page_table(page, whole=whole)):
            parts += [Text(), part]
        if found.recordings > len(page.rows):
            parts.append(Text(f"and {found.recordings - len(page.rows)} before (palpate store list)", style="dim"))
        parts += _odd(page)
    return Group(*parts)


def page_table(page: Page, *, whole: bool = True) -> Table:
    """A page of a list; ids whole, or as short as they can be told apart on it."""
    write = shortened((row.id for row in page.rows), whole=whole)
    table = folding_table("recording", "recorded (UTC)", "object", "action", "results", "odd", right=(5,))
    table.columns[0].no_wrap = True
    for row in page.rows:
        moment = f"{row.recorded_at:%Y-%m-%d %H:%M:%S}"
        # where ids are whole a row is a line, for whatever reads it
        results = ("; " if whole else "\n").join(map(entry_words, row.entries))
        table.add_row(
            write(row.id), moment, row.common_name or row.thing, row.action, results, str(len(row.notices) or "")
        )
    return table


def tell_next(cursor: str | None) -> None:
    """Say how the next page is asked for, where there is one."""
    if cursor is not None:
        print(f"more: --cursor {cursor}")


def page_json(page: Page) -> str:
    """A page of a list as JSON."""
    return json.dumps({"recordings": [_listed_plain(row) for row in page.rows], "cursor": page.cursor}, indent=1)


def _listed_plain(row: Listed) -> Mapping[str, object]:
    moments = {"recorded_at": row.recorded_at.isoformat(), "uploaded_at": row.uploaded_at.isoformat()}
    entries = [entry_plain(entry) for entry in row.entries]
    return {**vars(row), **moments, "id": str(row.id), "entries": entries, "notices": list(row.notices)}


def _things(found: Contents) -> Table:
    table = folding_table("object", "dataset", "name there", "recordings", right=(3,))
    for thing, count in found.things[:SHOWN]:
        table.add_row(thing.common_name or thing.id, thing.dataset, thing.id, str(count))
    _more(table, found.things)
    return table


def _setups(found: Contents, *, whole: bool) -> Table:
    write = shortened((setup.digest for setup, _ in found.setups), whole=whole)
    table = folding_table("setup", "devices", "recordings", right=(2,))
    table.columns[0].no_wrap = True
    for setup, count in found.setups[:SHOWN]:
        devices = ", ".join(f"{device.kind} {device.name}" for device in setup.devices) or "none stated"
        table.add_row(write(setup.digest), devices, str(count))
    _more(table, found.setups)
    return table


def _odd(page: Page) -> list[RenderableType]:
    """What was odd, each notice once with the actions that it is about."""
    told: dict[str, dict[str, None]] = {}
    for row in page.rows:
        for notice in row.notices:
            told.setdefault(notice, {})[row.action] = None
    lines = [f"{notice} ({', '.join(actions)})" for notice, actions in told.items()]
    return [Text(), Text("what was odd", style="bold"), bullets(lines)] if lines else []


def _more(table: Table, rows: tuple[object, ...]) -> None:
    if len(rows) > SHOWN:
        table.add_row(f"and {len(rows) - SHOWN} more")


def _top(probabilities: Mapping[str, float], most: int) -> str:
    ranked: Iterable[tuple[str, float]] = sorted(probabilities.items(), key=lambda item: -item[1])[:most]
    shown = ", ".join(f"{label} {number(probability, 2)}" for label, probability in ranked)
    return f"{shown}, ..." if len(probabilities) > most else shown
