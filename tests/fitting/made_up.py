"""Objects drawn from a network, and what a robot would measure on them; as specimens, in a store, and as CSV."""

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path

import numpy as np

import palpate
from palpate.fitting.data import Specimen
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.outcomes import Above, Below, Label, Reading
from palpate.robots.sampled import SampledRobot
from palpate.store.entries import Bound, Distribution, Entry, Value
from palpate.store.records import Recording, ThingRef
from palpate.store.store import Store

START = datetime(2024, 5, 1, 12, tzinfo=UTC)

WORKSHOP = """
format = "palpate-network/1"
[properties.kind]
states = ["bolt", "nut"]
prior = [0.6, 0.4]
[properties.metal]
states = ["steel", "brass", "zinc"]
parents = ["kind"]
[properties.metal.given]
bolt = [0.7, 0.2, 0.1]
nut = [0.1, 0.5, 0.4]
[properties.density]
unit = "g/cm^3"
family = "truncated-normal"
low = 0
parents = ["metal"]
[properties.density.given]
steel = {mean = 7.8, sd = 0.3}
brass = {mean = 8.5, sd = 0.2}
zinc = {mean = 7.0, sd = 0.4}
[properties.volume]
unit = "cm^3"
family = "lognormal"
parents = ["kind"]
[properties.volume.given]
bolt = {median = 4, log_sd = 0.3}
nut = {median = 1, log_sd = 0.4}
[properties.hardness]
unit = "GPa"
family = "gamma"
shape = 9
scale = 0.2
[properties.mass]
unit = "g"
formula = "density * volume"
[actions.look]
cost_s = 1
[actions.look.sensor]
property = "kind"
kind = "confusion"
outcomes = ["bolt", "nut", "else"]
[actions.look.sensor.given]
bolt = [0.9, 0.05, 0.05]
nut = [0.1, 0.8, 0.1]
[actions.weigh]
cost_s = 2
[actions.weigh.sensor]
property = "mass"
kind = "normal"
sd = 2
saturates_above = 35
[actions.scratch]
cost_s = 2
[actions.scratch.sensor]
property = "hardness"
kind = "student-t"
scale = 0.1
dof = 5
"""


WRONG = [
    ("[0.7, 0.2, 0.1]", "[0.2, 0.3, 0.5]"),
    ("[0.6, 0.4]", "[0.2, 0.8]"),
    ("mean = 7.8, sd = 0.3", "mean = 6.5, sd = 1.5"),
    ("mean = 8.5, sd = 0.2", "mean = 7.0, sd = 1.5"),
    ("median = 4, log_sd = 0.3", "median = 9, log_sd = 1"),
    ("shape = 9", "shape = 3"),
    ("[0.9, 0.05, 0.05]", "[0.5, 0.3, 0.2]"),
    ("sd = 2\n", "sd = 9\n"),
    ("scale = 0.1", "scale = 0.5"),
]
"""What a template that knows little has in place of the truth."""


def workshop(folder: Path, text: str = WORKSHOP) -> Path:
    path = folder / "workshop.toml"
    path.write_text(text, encoding="utf-8")
    return path


def wrong_workshop(folder: Path) -> Path:
    """The same properties and actions, with other numbers."""
    text = WORKSHOP
    for old, new in WRONG:
        assert old in text
        text = text.replace(old, new)
    return workshop(folder, text)


def network_of(folder: Path, text: str = WORKSHOP) -> Network:
    return load_network(workshop(folder, text))


def drawn(network: Network, count: int, seed: int, repeats: int = 2, name: str = "object") -> list[Specimen]:
    """Objects of a network with `repeats` outcomes of each action."""
    rng = np.random.default_rng(seed)
    values = palpate.ExactBelief(network).sample(count, rng)
    found = []
    for place in range(count):
        truth = {key: column[place].item() for key, column in values.items()}
        robot = SampledRobot(network, truth, rng)
        readings = {action: tuple(robot.perform(action) for _ in range(repeats)) for action in robot.actions()}
        found.append(Specimen(f"{name}{place:04d}", truth, readings))  # type: ignore[arg-type]
    return found


def entry_of(network: Network, action: str, outcome: object) -> Entry:
    """What a recorder would keep of an outcome."""
    measured = network.property(network.action(action).sensor.property)
    unit = None if isinstance(measured, CategoricalProperty) else measured.unit
    match outcome:
        case Label(label):
            return Distribution(measured.name, {label: 1.0})
        case Reading(value):
            return Value(measured.name, value, unit=unit)
        case Above(bound):
            return Bound(measured.name, above=bound, unit=unit)
        case Below(bound):
            return Bound(measured.name, below=bound, unit=unit)
    raise AssertionError(outcome)


def truth_entries(network: Network, specimen: Specimen) -> tuple[Entry, ...]:
    found: list[Entry] = []
    for name, value in specimen.truth.items():
        prop = network.property(name)
        if isinstance(prop, CategoricalProperty):
            found.append(Distribution(name, {str(value): 1.0}))
        else:
            found.append(Value(name, float(value), unit=prop.unit))
    return tuple(found)


def recordings_of(network: Network, specimens: Iterable[Specimen]) -> list[Recording]:
    """A recording of the truth of each object, and one for each reading."""
    found: list[Recording] = []
    for specimen in specimens:
        thing = ThingRef("made_up", specimen.name)
        rows = [("known", truth_entries(network, specimen), True)]
        rows += [(a, (entry_of(network, a, o),), False) for a, got in specimen.readings.items() for o in got]
        for action, entries, true in rows:
            moment = START + timedelta(seconds=len(found))
            found.append(Recording(moment, action, thing, entries=entries, ground_truth=true))
    return found


def fill(store: Store, network: Network, specimens: Iterable[Specimen]) -> None:
    store.put_many(recordings_of(network, specimens))


def write_csv(folder: Path, network: Network, specimens: Sequence[Specimen]) -> tuple[Path, Path]:
    """A table of objects, and one of readings."""
    names = [name for name in network.properties if name in specimens[0].truth]
    units = {name: getattr(network.property(name), "unit", None) for name in names}
    header = ["object", *(f"{name} [{units[name]}]" if units[name] else name for name in names)]
    rows = [[one.name, *(str(one.truth[name]) for name in names)] for one in specimens]
    objects, readings = folder / "objects.csv", folder / "readings.csv"
    objects.write_text("\n".join(",".join(row) for row in [header, *rows]) + "\n", encoding="utf-8")
    lines = ["object,action,outcome"]
    for one in specimens:
        for action, outcomes in one.readings.items():
            lines += [f"{one.name},{action},{_words(outcome)}" for outcome in outcomes]
    readings.write_text("\n".join(lines) + "\n", encoding="utf-8")
    return objects, readings


def _words(outcome: object) -> str:
    match outcome:
        case Label(label):
            return label
        case Reading(value):
            return repr(value)
        case Above(bound):
            return f"above {bound!r}"
        case Below(bound):
            return f"< {bound!r}"
    raise AssertionError(outcome)
