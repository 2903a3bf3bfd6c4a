"""A fit in the terminal: what each table was made from, and whether it is better than what was there before."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from math import isnan
from typing import TYPE_CHECKING

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.cli.belief_view import plain_table
from palpate.cli.network_view import sensor_words
from palpate.wording import number, plural

if TYPE_CHECKING:
    from palpate.fitting.data import Data
    from palpate.fitting.parts import Fitted, PropertyPart, SensorPart
    from palpate.fitting.scores import Score

__all__ = ["fit_report"]

FEWEST = 20
"""Notices are shown up to this number; all are in the file."""
SIGNIFICANT = 2.0
Scores = Mapping[tuple[str, str], "Score"]


def fit_report(fitted: Fitted, scores: Scores, data: Data) -> RenderableType:
    """Tables with counts and scores, and what is to be known of them."""
    sources = ", ".join(f"{source.kind} {source.name}" for source in data.sources)
    if fitted.sensors_only:
        fitted = replace(fitted, properties={})
    parts: list[RenderableType] = [Text(f"{plural(len(data.specimens), 'object')} from {sources}"), Text()]
    parts += [_table(fitted, scores), Text()]
    if scores:
        told = "score: log2 p of what was held out [bits per object], and how much better than the network before"
        parts.append(Text(f"{told}, mean ± SE over objects", style="dim"))
    lines = [*_notes(fitted), *data.notices]
    known = len(fitted.network.objects)
    if known and not fitted.sensors_only:
        lines.append(f"the {plural(known, 'known object')} of the template are others, and are left out")
    parts += [Text(f"- {line}") for line in lines[:FEWEST]]
    if len(lines) > FEWEST:
        parts.append(Text(f"- and {len(lines) - FEWEST} more"))
    return Group(*parts)


def _table(fitted: Fitted, scores: Scores) -> Table:
    head = ("property", "objects") if fitted.properties else ("sensor", "objects, readings")
    table = plain_table(*head, "score", "better by", "than", right=(1, 2, 3))
    for name, part in fitted.properties.items():
        made = str(part.objects) if part.counts is not None else "-"
        table.add_row(Text(name, style="bold"), made, *_score(scores.get(("property", name))))
    if fitted.actions and fitted.properties:
        table.add_row()
        table.add_row(*(Text(word, style="dim") for word in ("sensor", "objects, readings")))
    for name, sensor in fitted.actions.items():
        made = f"{sensor.objects}, {sensor.readings}" if sensor.counts is not None or sensor.bias else "-"
        table.add_row(Text(name, style="bold"), made, *_score(scores.get(("action", name))))
    return table


def _score(score: Score | None) -> tuple[str, str, str]:
    if score is None:
        return "", "", ""
    if isnan(score.difference):
        return f"{score.fitted:.2f}", "", score.against
    spread = "" if isnan(score.se) else f" ± {score.se:.2f}"
    return f"{score.fitted:.2f}", f"{round(score.difference, 2) + 0.0:+.2f}{spread}", score.against


def _notes(fitted: Fitted) -> Iterator[str]:
    parts: list[tuple[str, PropertyPart | SensorPart]] = [*fitted.properties.items(), *fitted.actions.items()]
    named: dict[str, list[str]] = {}
    for name, part in parts:
        if part.note:
            named.setdefault(part.note, []).append(name)
    for note, names in named.items():
        yield f"{', '.join(names)}: {note}"
    for name, part in parts:
        if part.left_out:
            yield f"{name}: too far out, and left out: {', '.join(part.left_out)}"
    for name, sensor in fitted.actions.items():
        if name in fitted.estimated:
            yield f"{name}: {sensor_words(fitted.network, fitted.network.actions[name].sensor)}"
        yield from _of_number(fitted, name, sensor)


def _of_number(fitted: Fitted, name: str, part: SensorPart) -> Iterator[str]:
    """What is to be known of a sensor of a number."""
    if part.bias is None:
        return
    unit = getattr(fitted.network.property(fitted.network.actions[name].sensor.property), "unit", "")
    saturated = f", {part.saturated} of them beyond saturation" if part.saturated else ""
    error = f"{number(part.bias.value, 2)} ± {number(part.bias.se, 2)} {unit}"
    line = f"{name}: {plural(part.readings, 'reading')}{saturated}, mean error {error}"
    if getattr(fitted.network.actions[name].sensor, "bias", 0.0):
        line += ", which its bias takes off"
    elif abs(part.bias.value) > SIGNIFICANT * part.bias.se:
        line += f"; its SD would be {number(part.bias.sd_without)} {unit} if it were calibrated by that"
    yield line
