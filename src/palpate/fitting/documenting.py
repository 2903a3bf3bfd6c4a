"""A fitted network as the tables of its file: the template's, with new numbers, counts and provenance."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.fitting.data import Data
from palpate.fitting.forms import form_of
from palpate.fitting.parts import Fitted, PropertyPart, SensorPart
from palpate.fitting.scores import Score
from palpate.fitting.settings import Settings
from palpate.fitting.template import PLACEHOLDERS, Template
from palpate.network.model import Network
from palpate.network.noises import NormalNoise
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.sensors import ConfusionSensor, NumberSensor

__all__ = ["Provenance", "document"]

Table = dict[str, Any]
OF_NORMAL = {"sd": "sd", "relative_sd": "relative_sd", "offset_sd": "offset_sd"}
SCORED = 3
"""Decimals of scores."""
LIMITS = {"low": "saturates_below", "high": "saturates_above"}
OF_STUDENT = {"sd": "scale", "relative_sd": "relative_scale", "offset_sd": "offset_sd"}


@dataclass(frozen=True)
class Provenance:
    """What a fitted network was made from, and how.

    Attributes
    ----------
    like
        Name or path of the template.
    command, version
        The command line, and the version of palpate; empty where there was none.
    date
        ISO 8601; empty where nobody said it and the data have none.
    scores
        On held-out objects, as `palpate.fitting.scores.held_out_scores` has them.
    """

    like: str
    command: str = ""
    version: str = ""
    date: str = ""
    scores: Mapping[tuple[str, str], Score] = field(default_factory=dict)

    def table(self, template: Template, data: Data, settings: Settings) -> Table:
        """The ``provenance`` of the network file."""
        sources = [{key: value for key, value in vars(source).items() if value != ""} for source in data.sources]
        table: Table = {
            "made_by": f"palpate {self.version}".strip(),
            "command": self.command,
            "date": self.date,
            "like": self.like,
            "like_digest": template.digest,
            "objects": len(data.specimens),
            "pseudo_count": settings.pseudo_count,
            "kept": list(settings.keep),
            "data": sources,
            "notices": list(data.notices),
            "held_out": self._held_out(),
        }
        return {key: value for key, value in table.items() if value not in ("", [], {})}

    def _held_out(self) -> Table:
        """Scores by ``property`` or ``action`` and its name [bits per object]; without what is not known."""
        found: Table = {}
        for (kind, name), score in self.scores.items():
            numbers = {"log2_p": score.fitted, "better_by": score.difference, "se": score.se}
            known = {key: round(value, SCORED) for key, value in numbers.items() if math.isfinite(value)}
            told = {"than": score.against} if score.against else {}
            found.setdefault(kind, {})[name] = {**known, **told, "objects": score.objects}
        return found


def document(
    template: Template, fitted: Fitted, data: Data, settings: Settings, provenance: Provenance, name: str
) -> Table:
    """The tables of the file.

    Parameters
    ----------
    name
        Of the network.
    """
    head = {"format": template.tables["format"], "name": name}
    tables = {**head, **{key: value for key, value in template.tables.items() if key not in head}}
    what = "Sensors fitted" if fitted.sensors_only else "Fitted"
    tables["source"] = f"{what} to {len(data.specimens)} objects; [provenance] says how"
    tables["properties"] = {
        key: _property(table, fitted.network, key, fitted.properties.get(key))
        for key, table in template.tables["properties"].items()
    }
    if "actions" in template.tables:
        tables["actions"] = {
            key: {**table, "sensor": _sensor(table["sensor"], fitted.network, key, fitted.actions[key])}
            for key, table in template.tables["actions"].items()
        }
    known = tables.pop("objects", {})
    tables["provenance"] = provenance.table(template, data, settings)
    # the objects of the template are others than those that properties were fitted to
    return {**tables, "objects": known} if known and fitted.sensors_only else tables


# Properties -------------------------------------------------------------------------------------


def _property(table: Mapping[str, Any], network: Network, name: str, part: PropertyPart | None) -> Table:
    if part is None or part.counts is None:
        return dict(table)
    prop = network.properties[name]
    old = {key: value for key, value in table.items() if key not in ("prior", "given", "counts", "source")}
    assert isinstance(prop, CategoricalProperty | ContinuousProperty)
    states = _states(network, prop.parents)
    source = {"source": _words(f"{part.objects} objects", part.left_out, part.note)}
    counts = {"counts": _nested(states, part.counts.tolist())}
    if isinstance(prop, CategoricalProperty):
        key = "given" if prop.parents else "prior"
        return {**old, **source, key: _nested(states, prop.table.tolist()), **counts}
    if form_of(prop.family, None) is None:
        return {**table, **source, **counts}
    estimated = PLACEHOLDERS[table["family"]]
    shared = {key: value for key, value in old.items() if key not in estimated}
    rows = _rows(prop, list(estimated), table.get("given", {}), states)
    return {**shared, **source, **({"given": rows} if prop.parents else rows), **counts}


def _rows(prop: ContinuousProperty, estimated: Sequence[str], before: Any, states: Sequence[Sequence[str]]) -> Any:
    """Parameters by configuration: new ones in place of those that were estimated, limits as they were."""
    columns: Mapping[str, NDArray[np.float64]] = {key: np.asarray(getattr(prop.family, key)) for key in estimated}

    def row(place: tuple[int, ...], old: Mapping[str, Any], rest: Sequence[Sequence[str]]) -> Table:
        if rest:
            return {state: row((*place, index), old.get(state, {}), rest[1:]) for index, state in enumerate(rest[0])}
        new = {key: float(column[place]) for key, column in columns.items()}
        return {**new, **{key: value for key, value in old.items() if key not in new}}

    return row((), before, states)


def _states(network: Network, parents: Sequence[str]) -> list[Sequence[str]]:
    return [p.states for p in map(network.property, parents) if isinstance(p, CategoricalProperty)]


def _nested(states: Sequence[Sequence[str]], values: Any) -> Any:
    """Values by the names of the states, nested in the order of the parents."""
    if not states:
        return values
    return {state: _nested(states[1:], value) for state, value in zip(states[0], values, strict=True)}


# Sensors ----------------------------------------------------------------------------------------


def _sensor(table: Mapping[str, Any], network: Network, name: str, part: SensorPart) -> Table:
    sensor = network.actions[name].sensor
    if isinstance(sensor, ConfusionSensor):
        return _confusion(table, network, sensor, part)
    if part.bias is None:
        return dict(table)
    assert isinstance(sensor, NumberSensor)
    keys = OF_NORMAL if isinstance(sensor.noise, NormalNoise) else OF_STUDENT
    own = (*keys.values(), *LIMITS.values(), "bias", "counts", "source")
    old = {key: value for key, value in table.items() if key not in own}
    new = {key: getattr(sensor, field) for field, key in keys.items() if getattr(sensor, field) > 0}
    new |= {"bias": sensor.bias} if sensor.bias else {}
    new |= {key: getattr(sensor, field) for field, key in LIMITS.items() if math.isfinite(getattr(sensor, field))}
    bias = f"mean error {part.bias.value:.3g} +- {part.bias.se:.2g}"
    source = _words(f"{part.readings} readings of {part.objects} objects, {bias}", part.left_out, part.note)
    return {**old, "source": source, **new, "counts": {"objects": part.objects, "readings": part.readings}}


def _confusion(table: Mapping[str, Any], network: Network, sensor: ConfusionSensor, part: SensorPart) -> Table:
    """A matrix stands in the file itself, also where the template had it in another one."""
    old = {key: value for key, value in table.items() if key not in ("csv", "given")}
    states = _states(network, [sensor.property])
    given = {"outcomes": list(sensor.outcomes), "given": _nested(states, sensor.by_state.tolist())}
    if part.counts is None:
        return {**old, **given}
    old = {key: value for key, value in old.items() if key not in ("counts", "source", "repeat_probability")}
    given |= {"repeat_probability": sensor.repeat_probability} if sensor.repeat_probability else {}
    source = _words(f"{part.readings} labels of {part.objects} objects", (), part.note)
    return {**old, "source": source, **given, "counts": _nested(states, part.counts.tolist())}


def _words(counted: str, left_out: Sequence[str], note: str) -> str:
    out = f"without {', '.join(left_out)}" if left_out else ""
    return "; ".join(part for part in (counted, out, note) if part)
