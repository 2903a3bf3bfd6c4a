"""One object held out: sensors calibrated on all others, then explorations of it from what was measured."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from palpate.experiments.bench.pairs import partner_of, telling_rows
from palpate.experiments.comparison.contest import method_rows, objective_of
from palpate.experiments.comparison.methods import EXACT, RANDOM, ByPolicy, Method
from palpate.experiments.comparison.trial import Trial
from palpate.experiments.engines import Engine
from palpate.experiments.running import Row, Task
from palpate.experiments.shared import SharedNetwork
from palpate.experiments.tapes import Tape
from palpate.fitting.fit import fit
from palpate.fitting.robot_data import Measured, most_probable, read_outcomes
from palpate.fitting.scores import log2_sensor
from palpate.fitting.settings import Settings
from palpate.fitting.template import Template
from palpate.inference.belief import Belief
from palpate.network.model import Network
from palpate.outcomes import Above, Below, Outcome, Reading
from palpate.selection.policies import Greedy

__all__ = ["CALIBRATED", "GREEDY", "PUBLISHED", "SENSORS", "TOLD", "by_sensor", "calibrated_without", "held_out_tasks"]

CALIBRATED, PUBLISHED, TOLD = "calibrated", "as published", "as told"
"""Worlds: sensors calibrated on the other objects; those of the network; vectors and SDs as estimators tell them."""
SENSORS = "sensors"
"""Rows with the log score of each sensor on the object that was held out."""
GREEDY = Method("exact-greedy", "exact inference, largest gain", ByPolicy(EXACT, Greedy()), EXACT)


def by_sensor(outcome: Outcome) -> Outcome:
    """An outcome of which the sensor model says how sure it is: the label of a vector, a number without its own SD.

    Examples
    --------
    >>> by_sensor(Reading(118.0, sd=1.5, unit="g"))
    Reading(value=118.0, sd=None, unit='g')
    """
    if isinstance(outcome, Reading | Above | Below):
        return replace(outcome, sd=None)
    return most_probable(outcome)


def calibrated_without(network: Network, measured: Sequence[Measured], thing: str) -> Network:
    """The network with sensors calibrated on what was measured of all objects but one."""
    others = read_outcomes(network, network.objects, [one for one in measured if one.thing != thing], "the others")
    settings = Settings(keep=tuple(network.properties), whole_sensors=True)
    return fit(Template(network, {}), others.specimens, settings).network


@dataclass(frozen=True)
class HeldOut:
    """One object, and what was measured of all of them.

    Parameters
    ----------
    shared
        The network whose sensors are calibrated.
    place
        Of the object among all of them.
    """

    shared: SharedNetwork
    measured: tuple[Measured, ...]
    place: int
    thing: str

    @property
    def network(self) -> Network:
        """The network as it is."""
        return self.shared.network

    @property
    def own(self) -> list[Measured]:
        """What was measured of the object."""
        return [one for one in self.measured if one.thing == self.thing]

    def calibrated(self) -> Network:
        """The network with sensors calibrated on the other objects."""
        return calibrated_without(self.network, self.measured, self.thing)

    def tapes(self, used: Callable[[Outcome], Outcome] = by_sensor) -> list[Tape]:
        """The n-th outcome of each action, for each n."""
        outcomes: dict[str, list[Outcome]] = {}
        for one in self.own:
            outcomes.setdefault(one.action, []).append(used(one.outcome))
        known = self.network.object(self.thing)
        truth = {name: true.value for name, true in known.truth.items() if true.scored}
        order = [action for action in self.network.actions if action in outcomes]
        return [
            Tape(self.thing, n, {action: outcomes[action][n] for action in order}, truth, known.is_trick)
            for n in range(min(map(len, outcomes.values()), default=0))
        ]


@dataclass(frozen=True)
class ExploreTask(HeldOut):
    """Explorations of one object, from outcomes that were measured once, whatever is believed."""

    @property
    def key(self) -> str:
        """The object's place."""
        return f"explored-{self.place:05d}"

    def run(self) -> list[Row]:
        """A row of scores for each world, method, repetition and belief."""
        calibrated, tapes = self.calibrated(), self.tapes()
        rows = [*_explored(CALIBRATED, calibrated, tapes), *_explored(PUBLISHED, self.network, tapes)]
        return [*rows, *_explored(TOLD, calibrated, self.tapes(lambda outcome: outcome))]


@dataclass(frozen=True)
class PairTask(HeldOut):
    """Whether an object is told from the one that it looks like, or that looks like it."""

    @property
    def key(self) -> str:
        """The object's place."""
        return f"pair-{self.place:05d}"

    def run(self) -> list[Row]:
        """A row for each step of the explorations."""
        calibrated = self.calibrated()
        return [row for tape in self.tapes() for row in telling_rows(calibrated, tape)]


@dataclass(frozen=True)
class SensorTask(HeldOut):
    """How well calibrated sensors predict what was measured of the object."""

    @property
    def key(self) -> str:
        """The object's place."""
        return f"sensors-{self.place:05d}"

    def run(self) -> list[Row]:
        """A row for each sensor that measures what is known of the object."""
        calibrated = self.calibrated()
        (own,) = read_outcomes(self.network, self.network.objects, self.own, "the object").specimens
        rows: list[Row] = []
        for name in self.network.actions:
            found, before = (log2_sensor(one, one.actions[name], own) for one in (calibrated, self.network))
            if found is not None and before is not None:
                about: Row = {"world": SENSORS, "method": name, "object": self.thing, "weight": 1.0}
                rows.append({**about, "calibrated_log2_p": found, "published_log2_p": before})
        return rows


def held_out_tasks(network: Network, measured: Sequence[Measured]) -> list[Task]:
    """The tasks of all objects of a network, of which everything was measured."""
    shared, all_of_them, found = SharedNetwork(network), tuple(measured), list[Task]()
    for place, thing in enumerate(network.objects):
        found += [ExploreTask(shared, all_of_them, place, thing), SensorTask(shared, all_of_them, place, thing)]
        if partner_of(network, thing) is not None:
            found.append(PairTask(shared, all_of_them, place, thing))
    return found


def _explored(world: str, network: Network, tapes: Sequence[Tape]) -> Iterator[Row]:
    objective, costs_s = objective_of(network), {name: action.cost_s for name, action in network.actions.items()}
    priors: dict[Engine, Belief] = {}
    for tape in tapes:
        trial = Trial(network, tape, objective, costs_s, 0, priors)
        for method in (GREEDY, RANDOM):
            yield from method_rows(world, method, trial)
