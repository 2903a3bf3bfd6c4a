"""Objects of a store in the terminal, and as JSON."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.cli.store_view import entry_words
from palpate.store.content import entry_plain, setup_plain, thing_plain
from palpate.store.decoding import CLASSES, entry_from
from palpate.wording import number, plural

if TYPE_CHECKING:
    from palpate.store.audit import Change
    from palpate.store.measured import Measured
    from palpate.store.records import Setup
    from palpate.store.things import Thing

__all__ = ["change_lines", "thing_json", "thing_view", "things_json", "things_table"]


def things_table(things: Sequence[Thing]) -> Table:
    """A row for each object."""
    table = _table("object", "called", "recordings", "known", "counts as")
    for thing in things:
        known = "\n".join(entry_words(one.entry) for one in thing.known)
        into = "" if thing.merged_into is None else f"{thing.merged_into.dataset}/{thing.merged_into.id}"
        table.add_row(thing.path, thing.ref.common_name or "", str(thing.recordings), known, into)
    return table


def thing_view(thing: Thing, measured: Sequence[Measured], changes: Sequence[Change]) -> RenderableType:
    """All of an object."""
    parts: list[RenderableType] = [Text.assemble((thing.path, "bold"), f", {plural(thing.recordings, 'recording')}")]
    parts += [Text(line) for line in _description(thing)]
    if thing.known:
        table = _table("known", "from")
        for one in thing.known:
            table.add_row(entry_words(one.entry), one.source)
        parts += [Text(), table]
    if measured:
        parts += [Text(), _measured_table(measured)]
    if changes:
        parts += [Text(), _changes_table(changes)]
    return Group(*parts)


def things_json(things: Sequence[Thing]) -> str:
    """Objects as JSON."""
    return json.dumps([_plain(thing) for thing in things], indent=1)


def thing_json(thing: Thing, measured: Sequence[Measured], changes: Sequence[Change]) -> str:
    """All of an object as JSON."""
    rows = [{**vars(one), "setup": setup_plain(one.setup), "labels": dict(one.labels)} for one in measured]
    return json.dumps({**_plain(thing), "measured": rows, "history": [_change_plain(one) for one in changes]}, indent=1)


def _description(thing: Thing) -> Iterator[str]:
    ref = thing.ref
    told = {"called": ref.common_name, "maker": ref.maker, "aliases": ", ".join(ref.aliases)}
    told |= {name: value if isinstance(value, str) else json.dumps(value) for name, value in ref.attributes.items()}
    told["images"] = ", ".join(image.name for image in thing.images)
    told["counts as it"] = ", ".join(f"{one.dataset}/{one.id}" for one in thing.merged)
    if thing.merged_into is not None:
        told["counts as"] = f"{thing.merged_into.dataset}/{thing.merged_into.id}"
    return (f"{name}: {value}" for name, value in told.items() if value)


def _measured_table(measured: Sequence[Measured]) -> Table:
    table, before = _table("measured", "by", "results", "mean", "labels"), None
    for one in measured:
        failed = f", {one.failed} failed" if one.failed else ""
        spread = "" if one.sd is None else f" ± {number(one.sd)}"
        mean = "" if one.mean is None else f"{number(one.mean)}{spread} {one.unit}"
        ranked = sorted(one.labels.items(), key=lambda item: (-item[1], item[0]))
        labels = ", ".join(f"{label} {count}" for label, count in ranked)
        # what many devices measured would be folded into a list of them in each row
        by, before = "the same" if one.setup == before else _devices(one.setup), one.setup
        table.add_row(one.property or "(whole measurement)", by, f"{one.results}{failed}", mean, labels)
    return table


def _changes_table(changes: Sequence[Change]) -> Table:
    table = _table("when (UTC)", "who", "what", "")
    for one in changes:
        undone = "" if one.undone_at is None else f"taken back by {one.undone_by or 'somebody'}"
        what = "\n".join((one.what, *change_lines(one.detail)))
        table.add_row(f"{one.at:%Y-%m-%d %H:%M:%S}", one.who or "", what, undone)
    return table


def change_lines(detail: Any) -> Iterator[str]:
    """What was there before and after, part by part; or what an object was merged into."""
    if isinstance(detail, list):
        for part in detail:
            before, after = (_words(part[side]) if side in part else "nothing" for side in ("before", "after"))
            yield f"{'.'.join(part['field'])}: {before} -> {after}"
    elif "into" in detail:
        yield f"into {'/'.join(detail['into'])}"
    elif detail:
        yield json.dumps(detail)


def _words(value: Any) -> str:
    """A part of a description; what is known of a property reads as a result does."""
    if isinstance(value, dict) and value.get("kind") in CLASSES:
        return entry_words(entry_from(value))
    return value if isinstance(value, str) else json.dumps(value)


def _devices(setup: Setup) -> str:
    return ", ".join(f"{device.kind} {device.name}" for device in setup.devices) or "none stated"


def _plain(thing: Thing) -> Mapping[str, Any]:
    into = thing.merged_into
    return {
        **thing_plain(thing.ref),
        "known": [{"source": one.source, **entry_plain(one.entry)} for one in thing.known],
        "images": [vars(image) for image in thing.images],
        "merged_into": None if into is None else [into.dataset, into.id],
        "merged": [[one.dataset, one.id] for one in thing.merged],
        "recordings": thing.recordings,
    }


def _change_plain(change: Change) -> Mapping[str, Any]:
    undone = None if change.undone_at is None else change.undone_at.isoformat()
    plain = {"at": change.at.isoformat(), "who": change.who, "what": change.what, "detail": change.detail}
    return {**plain, "undone_at": undone, "undone_by": change.undone_by}


def _table(*names: str) -> Table:
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in names:
        table.add_column(name, overflow="fold")
    return table
