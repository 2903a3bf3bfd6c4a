"""How well what measures agrees with what is known, and with others: computed from results that are seen."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import sqrt
from statistics import fmean, stdev

from scipy.special import stdtrit

from palpate.store.censored_results import Censored, censored_of
from palpate.store.entries import Value
from palpate.store.known_units import factor_of
from palpate.store.store import Store
from palpate.store.texts import LARGEST_SI
from palpate.store.things import Known
from palpate.store.viewing import Viewer
from palpate.store.visible_known import known_of_merged
from palpate.store.visible_results import Group, Grouped, groups_of
from palpate.store.visible_things import things_by_name
from palpate.store.visible_truths import properties_with_truth

__all__ = ["Agreement", "Cell", "DeviceError", "Difference", "agreements", "agreements_with_truth", "interval"]

ThingKey = tuple[str, str]
MOST_CENSORED = 0.1
"""Share of bounds and intervals among the results of a cell that counts.

Of a normal distribution without its upper tenth the mean is 0.2 SD too low; without its upper half 0.8 SD.
"""


@dataclass(frozen=True)
class Cell:
    """What one device measured of one object: mean, SD (n - 1) and count; the true value where one is known.

    `censored` results are bounds or intervals, as "above 95 kPa": no mean holds them.
    It is None where there are no others.
    """

    device: str
    dataset: str
    thing: str
    count: int
    censored: int
    mean: float | None
    sd: float | None
    truth: float | None

    @property
    def key(self) -> ThingKey:
        """The object."""
        return self.dataset, self.thing

    @property
    def fair_mean(self) -> float | None:
        """The mean, unless so many results are censored that it tells of the others only."""
        return None if self.censored > MOST_CENSORED * (self.count + self.censored) else self.mean

    @property
    def error(self) -> float | None:
        """How far the mean is from the truth; None as well where too many results are censored."""
        mean = self.fair_mean
        return None if self.truth is None or mean is None else mean - self.truth


@dataclass(frozen=True)
class DeviceError:
    """Errors of one device over the objects of which the truth is known, each object once.

    Values of one object are not independent of each other, so that it is the objects that are counted.

    Attributes
    ----------
    objects, values
        That it measured.
    censored
        Results that are bounds or intervals, which are no values.
    known
        Objects of them of which the truth is known, and that count.
    left_out
        Objects of which the truth is known, and that do not count: more than a tenth of the results are censored.
    bias, sd, rms
        Mean, SD (n - 1) and root mean square of the errors of these.
    interval
        Where the bias lies with 95 % confidence, by Student's t; None below two objects.
    """

    device: str
    objects: int
    values: int
    censored: int
    known: int
    left_out: int
    bias: float | None
    sd: float | None
    rms: float | None
    interval: tuple[float, float] | None


@dataclass(frozen=True)
class Difference:
    """How much more one device measures than another one of the objects that both measured, each object once.

    Attributes
    ----------
    objects
        That both measured, without those of which either one's results are censored too often.
    first_values, second_values
        How many values of these each has.
    mean, sd, interval
        As of `DeviceError`, of the differences of their means.
    """

    first: str
    second: str
    objects: int
    first_values: int
    second_values: int
    mean: float
    sd: float | None
    interval: tuple[float, float] | None


@dataclass(frozen=True)
class Agreement:
    """One property: a cell for each device and object, and the errors of each device.

    `unknown_units` are those of results and of true values that are left out, as they are not known here.
    """

    property: str
    unit: str
    cells: tuple[Cell, ...]
    devices: tuple[DeviceError, ...]
    unknown_units: tuple[str, ...] = ()

    def between_sd(self, dataset: str, thing: str) -> float | None:
        """SD (n - 1) of the means of the devices that measured an object; None where it was one."""
        means = [cell.fair_mean for cell in self.cells if cell.key == (dataset, thing)]
        return _sd([mean for mean in means if mean is not None])

    def differences(self) -> tuple[Difference, ...]:
        """Each pair of devices that measured an object both."""
        pairs = combinations([one.device for one in self.devices], 2)
        found = (_difference(first, second, self.cells) for first, second in pairs)
        return tuple(one for one in found if one is not None)


def interval(values: Sequence[float]) -> tuple[float, float] | None:
    """Where the mean that values are drawn about lies with 95 % confidence; None where there is one value.

    Examples
    --------
    >>> [round(end, 2) for end in interval([1.0, 2.0, 3.0])]
    [-0.48, 4.48]
    """
    if len(values) < 2:
        return None
    half = float(stdtrit(len(values) - 1, 0.975)) * stdev(values) / sqrt(len(values))
    return fmean(values) - half, fmean(values) + half


def _difference(first: str, second: str, cells: Sequence[Cell]) -> Difference | None:
    ours, theirs = (_fair_means(name, cells) for name in (first, second))
    both = [key for key in ours if key in theirs]
    if not both:
        return None
    offs = [ours[key][0] - theirs[key][0] for key in both]
    first_values, second_values = (sum(of[key][1] for key in both) for of in (ours, theirs))
    return Difference(first, second, len(both), first_values, second_values, fmean(offs), _sd(offs), interval(offs))


def _fair_means(device: str, cells: Sequence[Cell]) -> dict[ThingKey, tuple[float, int]]:
    """Mean and count of each object."""
    own = ((cell.key, cell.fair_mean, cell.count) for cell in cells if cell.device == device)
    return {key: (mean, count) for key, mean, count in own if mean is not None}


def _sd(values: Sequence[float]) -> float | None:
    return stdev(values) if len(values) > 1 else None


def agreements(store: Store, viewer: Viewer, property: str) -> Agreement:
    """Compare all that measured a property; results that are known to be true are the measure, and not compared."""
    return all_agreements(store, viewer, [property])[0]


def agreements_with_truth(store: Store, viewer: Viewer) -> list[Agreement]:
    """As `agreements`, of each property of which something is known, by name."""
    return all_agreements(store, viewer, properties_with_truth(store, viewer))


def all_agreements(store: Store, viewer: Viewer, properties: Collection[str]) -> list[Agreement]:
    """As `agreements`, of several properties by a few questions for all of them."""
    groups, censored = groups_of(store, viewer, properties), censored_of(store, viewer, properties)
    keys = {(one.dataset, one.thing) for own in groups.values() for one in own.groups}
    keys |= {key for own in censored.values() for _, key in own.counts}
    things = things_by_name(store, viewer, keys)
    merged = known_of_merged(store, viewer, keys)
    said: dict[str, dict[ThingKey, float]] = defaultdict(dict)
    for key, thing in things.items():
        for name, value in _said((*thing.known, *merged.get(key, ())), groups):
            said[name].setdefault(key, value)
    return [_agreement(name, own, censored[name], said[name]) for name, own in groups.items()]


def _agreement(property: str, values: Grouped, censored: Censored, said: Mapping[ThingKey, float]) -> Agreement:
    measured: dict[tuple[str, ThingKey], list[Group]] = defaultdict(list)
    for one in values.groups:
        if not one.ground_truth:
            measured[one.measured_by, (one.dataset, one.thing)].append(one)
    known = _truths(values.groups, said)
    names = sorted({*measured, *censored.counts})
    cells = tuple(_cell(*one, measured[one], censored.counts[one], known.get(one[1])) for one in names)
    of_device: dict[str, list[Cell]] = defaultdict(list)
    for cell in cells:
        of_device[cell.device].append(cell)
    unknown = tuple(sorted(values.unknown_units | censored.unknown_units))
    errors = tuple(_errors(name, own) for name, own in of_device.items())
    return Agreement(property, values.unit, cells, errors, unknown)


def _cell(device: str, key: ThingKey, groups: Sequence[Group], censored: int, truth: float | None) -> Cell:
    """Setups of one device together."""
    if not groups:
        return Cell(device, *key, 0, censored, None, None, truth)
    count, mean = _together(groups)
    squares = sum(one.squares + one.count * (one.mean - mean) ** 2 for one in groups)
    return Cell(device, *key, count, censored, mean, sqrt(squares / (count - 1)) if count > 1 else None, truth)


def _together(groups: Sequence[Group]) -> tuple[int, float]:
    count = sum(one.count for one in groups)
    return count, sum(one.count * one.mean for one in groups) / count


def _errors(device: str, own: Sequence[Cell]) -> DeviceError:
    errors = [cell.error for cell in own if cell.error is not None]
    bias = fmean(errors) if errors else None
    rms = sqrt(fmean(error**2 for error in errors)) if errors else None
    values, censored = sum(cell.count for cell in own), sum(cell.censored for cell in own)
    left_out = sum(cell.truth is not None for cell in own) - len(errors)
    counts = (len(own), values, censored, len(errors), left_out)
    return DeviceError(device, *counts, bias, _sd(errors), rms, interval(errors))


def _truths(groups: Sequence[Group], said: Mapping[ThingKey, float]) -> Mapping[ThingKey, float]:
    """The true value of each object: what is said of it, of what counts as it, or the mean of true recordings."""
    true: dict[ThingKey, list[Group]] = defaultdict(list)
    for one in groups:
        if one.ground_truth:
            true[one.dataset, one.thing].append(one)
    return {**{key: _together(own)[1] for key, own in true.items()}, **said}


def _said(known: Iterable[Known], groups: Mapping[str, Grouped]) -> Iterator[tuple[str, float]]:
    """Property and value, in the property's unit, of each number that is said of an object; the first one counts.

    Of one whose unit is not known here it is noted that it is left out.
    """
    for one in known:
        entry = one.entry
        own = groups.get(entry.property or "")
        if isinstance(entry, Value) and entry.unit is not None and own is not None and own.unit:
            factor, told = factor_of(entry.unit), factor_of(own.unit)
            if factor is None or told is None:
                own.unknown_units.add(entry.unit if factor is None else own.unit)
            elif abs(entry.value * factor) <= LARGEST_SI:
                yield entry.property, entry.value * factor / told
