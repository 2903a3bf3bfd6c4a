"""Why there is no stress over strain of a series that looks like a squeeze."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import prod

from palpate.server.plots.squeezes import MM, NEWTON
from palpate.store.records import Channel, Series

__all__ = ["no_squeeze_words"]

GAPS = ("position", "distance", "length", "width", "gap")
FORCES = ("force",)


def no_squeeze_words(series: Series) -> str:
    """Why a series that has a gap and a force is drawn as no squeeze; empty where it has not both.

    It is for those of which `palpate.server.plots.squeezes.squeeze_of` makes nothing.
    """
    gaps, forces = _looking_like(series, GAPS, MM), _looking_like(series, FORCES, NEWTON)
    if not gaps or not forces:
        return ""
    why = (
        _none_alone("gap", gaps, MM)
        or _none_alone("force", forces, NEWTON)
        or _apart(_one(gaps, MM), _one(forces, NEWTON))
    )
    return f"Stress over strain is not drawn: {why}."


def _looking_like(series: Series, quantities: Sequence[str], units: Mapping[str, float]) -> list[Channel]:
    return [one for one in series.channels if one.unit in units or one.quantity.lower() in quantities]


def _fits(units: Mapping[str, float]) -> Callable[[Channel], bool]:
    return lambda one: one.unit in units and one.values.ndim == 1


def _one(channels: Sequence[Channel], units: Mapping[str, float]) -> Channel:
    return next(filter(_fits(units), channels))


def _none_alone(what: str, channels: Sequence[Channel], units: Mapping[str, float]) -> str:
    """Why there is not exactly one of them; empty where there is."""
    fitting = list(filter(_fits(units), channels))
    if len(fitting) == 1:
        return ""
    if fitting:
        return f"{_names(fitting)} may each be the {what}, expected one in the series"
    found = channels[0]
    if found.unit in units:
        return f"{found.name} has {prod(found.values.shape[1:])} numbers in each sample, expected one"
    unit = "has no unit" if found.unit is None else f"is in {found.unit[:40]}"
    return f"{found.name} {unit}, expected {', '.join(units)}"


def _apart(gap: Channel, force: Channel) -> str:
    gaps, forces = len(gap.values), len(force.values)
    if gaps != forces:
        return f"{gap.name} has {gaps} samples and {force.name} {forces}, expected as many, taken together"
    return f"no sample has both {gap.name} and {force.name}"


def _names(channels: Sequence[Channel]) -> str:
    return " and ".join(one.name for one in channels)
