"""A store and its recordings in the terminal."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.figures.wording import number, plural
from palpate.store.content import entry_plain, setup_plain, thing_plain
from palpate.store.entries import Bound, Distribution, Entry, FailedEntry, Interval, Value
from palpate.store.listing import Listed, Page, list_recordings
from palpate.store.overview import Contents, contents

if TYPE_CHECKING:
    from palpate.store.records import Recording
    from palpate.store.store import Store

__all__ = ["entry_words", "overview", "page_json", "page_table", "recording_view"]

SHOWN = 20


def entry_words(entry: Entry) -> str:
    """A result in few words.

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
            return f"{name} {_top(probabilities)}"
        case Interval(name, low, high, unit):
            return f"{name} {number(low)} to {number(high)} {unit or '(unit not stated)'}"
        case Bound(name, above, below, unit):
            end = f"above {number(above)}" if above is not None else f"below {number(below)}"
            return f"{name} {end} {unit or '(unit not stated)'}"
        case FailedEntry(reason, name):
            return f"{name or 'all'} failed: {reason}"


def overview(store: Store) -> RenderableType:
    """Objects, setups, and the last recordings with their notices."""
    page, found = list_recordings(store, limit=SHOWN), contents(store)
    head = f"{plural(found.recordings, 'recording')} of {plural(len(found.things), 'object')}"
    if found.episodes:
        head += f" and {plural(found.episodes, 'episode')}"
    parts: list[RenderableType] = [Text(f"{head} in {store.engine.url!r}")]
    if found.recordings:
        parts += [_things(found), _setups(found), page_table(page)]
        parts += _odd(page)
    return Group(*parts)


def page_table(page: Page) -> Table:
    """A page of a list."""
    table = Table(box=None, pad_edge=False, header_style="bold")
    table.add_column("recording", no_wrap=True)
    for name in ("recorded (UTC)", "object", "action", "results", "odd"):
        table.add_column(name, overflow="fold")
    for row in page.rows:
        moment = f"{row.recorded_at:%Y-%m-%d %H:%M:%S}"
        results = "\n".join(map(entry_words, row.entries))
        table.add_row(
            str(row.id), moment, row.common_name or row.thing, row.action, results, str(len(row.notices) or "")
        )
    return table


def page_json(page: Page) -> str:
    """A page of a list as JSON."""
    return json.dumps({"recordings": [_listed_plain(row) for row in page.rows], "cursor": page.cursor}, indent=1)


def recording_view(recording: Recording) -> RenderableType:
    """All of a recording but its numbers."""
    plain = json.loads(recording.document)
    setup = {kind: value for kind, value in setup_plain(recording.setup).items() if value}
    shown = {**plain, "id": str(recording.id), "digest": recording.digest, "visibility": recording.visibility}
    shown |= {"thing": thing_plain(recording.thing), "setup": setup, "log": recording.log}
    return Text(json.dumps({name: value for name, value in shown.items() if value not in (None, [], "")}, indent=1))


def _listed_plain(row: Listed) -> Mapping[str, object]:
    moments = {"recorded_at": row.recorded_at.isoformat(), "uploaded_at": row.uploaded_at.isoformat()}
    entries = [entry_plain(entry) for entry in row.entries]
    return {**vars(row), **moments, "id": str(row.id), "entries": entries, "notices": list(row.notices)}


def _things(found: Contents) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("object", "dataset", "name there", "recordings"):
        table.add_column(name, overflow="fold")
    for thing, count in found.things[:SHOWN]:
        table.add_row(thing.common_name or thing.id, thing.dataset, thing.id, str(count))
    _more(table, found.things)
    return table


def _setups(found: Contents) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("setup", "devices", "recordings"):
        table.add_column(name, overflow="fold")
    for setup, count in found.setups[:SHOWN]:
        devices = ", ".join(f"{device.kind} {device.name}" for device in setup.devices) or "none stated"
        table.add_row(setup.digest[:8], devices, str(count))
    _more(table, found.setups)
    return table


def _odd(page: Page) -> list[Text]:
    """What was odd, each notice once with the actions that it is about."""
    told: dict[str, dict[str, None]] = {}
    for row in page.rows:
        for notice in row.notices:
            told.setdefault(notice, {})[row.action] = None
    lines = [Text(f"- {notice} ({', '.join(actions)})") for notice, actions in told.items()]
    return [Text("what was odd", style="bold"), *lines] if lines else []


def _more(table: Table, rows: tuple[object, ...]) -> None:
    if len(rows) > SHOWN:
        table.add_row(f"and {len(rows) - SHOWN} more")


def _top(probabilities: Mapping[str, float], most: int = 2) -> str:
    ranked: Iterable[tuple[str, float]] = sorted(probabilities.items(), key=lambda item: -item[1])[:most]
    shown = ", ".join(f"{label} {number(probability, 2)}" for label, probability in ranked)
    return f"{shown}, ..." if len(probabilities) > most else shown
