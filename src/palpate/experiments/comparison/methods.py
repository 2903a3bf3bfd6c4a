"""Methods that are compared: how actions are chosen, and whose beliefs are scored."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import lru_cache
from itertools import combinations, permutations
from typing import Protocol

import numpy as np

from palpate.experiments.comparison.trial import Trial
from palpate.experiments.comparison.vector_fed import VectorFed
from palpate.experiments.engines import Engine, Exact, MessagePassing
from palpate.experiments.tapes import stable_int
from palpate.inference.exact import ExactBelief
from palpate.inference.message_passing.settings import Settings
from palpate.network.model import Network
from palpate.selection.foresight import foresight
from palpate.selection.lookahead import LookAhead
from palpate.selection.objectives import Learn
from palpate.selection.policies import Choice, Greedy, GreedyPerCost, Policy

__all__ = [
    "AllOrders",
    "BalancedOrders",
    "ByPolicy",
    "Chooser",
    "Course",
    "Method",
    "StaticSets",
    "all_methods",
    "best_sets",
    "few_methods",
    "methods_on_costs",
]


@dataclass(frozen=True)
class Course:
    """A sequence of actions that a chooser takes.

    Parameters
    ----------
    weight
        Probability of it; those of all courses that count at a step sum to one.
    steps
        The numbers of actions after which it counts.
    gains
        What the chooser's engine expected [bits] of the actions left, before each action and at the
        end; empty where nothing was expected.
    """

    actions: tuple[str, ...]
    weight: float
    steps: tuple[int, ...]
    gains: tuple[Mapping[str, float], ...] = field(default=(), compare=False)


class Chooser(Protocol):
    """Chooses all actions of a tape."""

    def courses(self, trial: Trial) -> list[Course]:
        """The sequences of actions, with their probabilities."""


@dataclass(frozen=True)
class ByPolicy:
    """A policy, with the gains that an engine expects."""

    engine: Engine
    policy: Policy

    def courses(self, trial: Trial) -> list[Course]:
        """The one course that the policy takes until no action is left."""
        taken: tuple[str, ...] = ()
        gains = [trial.gains(self.engine, taken)]
        rng = np.random.default_rng(trial.seed)
        while gains[-1]:
            belief = trial.belief(self.engine, taken)
            action = self.policy.choose(Choice(belief, trial.objective, gains[-1], trial.costs_s, rng, taken))
            if action is None:
                break
            taken = (*taken, action)
            gains.append(trial.gains(self.engine, taken))
        return [Course(taken, 1.0, tuple(range(len(taken) + 1)), tuple(gains))]


@dataclass(frozen=True)
class AllOrders:
    """Every order of the actions, all as likely: the expectation of choosing at random, without its noise."""

    def courses(self, trial: Trial) -> list[Course]:
        """All orders."""
        orders = list(permutations(trial.actions))
        return [Course(order, 1 / len(orders), tuple(range(len(order) + 1))) for order in orders]


@dataclass(frozen=True)
class BalancedOrders:
    """As many orders as there are actions, by chance, but each action stands once at each place.

    For engines to which the order of evidence matters, where all orders would take too long.
    """

    def courses(self, trial: Trial) -> list[Course]:
        """The rotations of an order that follows from the object, the repetition and the trial's seed."""
        key = (stable_int(trial.tape.object), trial.tape.repetition)
        rng = np.random.default_rng(np.random.SeedSequence(trial.seed, spawn_key=key))
        order = [trial.actions[i] for i in rng.permutation(len(trial.actions))]
        turned = [(*order[i:], *order[:i]) for i in range(len(order))]
        return [Course(each, 1 / len(turned), tuple(range(len(order) + 1))) for each in turned]


@dataclass(frozen=True)
class StaticSets:
    """For each number of actions the set that tells most together, fixed beforehand."""

    def courses(self, trial: Trial) -> list[Course]:
        """A course for each size of set."""
        sets = best_sets(trial.network, trial.objective, trial.actions)
        return [Course(chosen, 1.0, (size,)) for size, chosen in enumerate(sets)]


@dataclass(frozen=True)
class Method:
    """A way of choosing, and the engine whose beliefs are scored.

    Parameters
    ----------
    words
        What people read.
    """

    name: str
    words: str
    chooser: Chooser
    scored_by: Engine


EXACT, RELEASED, BEST = Exact(), MessagePassing(Settings.as_released()), VectorFed(Settings.as_released())
REPAIRED, WRITTEN = MessagePassing(Settings.repaired()), MessagePassing(Settings.as_written())

RANDOM = Method("rand-scored-exact", "all orders alike, exact inference", AllOrders(), EXACT)
PER_COST = Method("exact-per-cost", "exact inference, largest gain per cost", ByPolicy(EXACT, GreedyPerCost()), EXACT)
TWO_AHEAD = Method("look-ahead-2", "exact inference, two actions ahead", ByPolicy(EXACT, LookAhead(2)), EXACT)


def few_methods() -> tuple[Method, ...]:
    """The methods of the primary contrast and what takes it apart."""
    greedy, released = ByPolicy(EXACT, Greedy()), ByPolicy(RELEASED, Greedy())
    return (
        Method("exact-greedy", "exact inference, largest gain", greedy, EXACT),
        Method("actsel", "ACTSEL as released", released, RELEASED),
        Method("actsel-best-case", "ACTSEL given C[o, :] / sum for a label", ByPolicy(BEST, Greedy()), BEST),
        Method("actsel-scored-exact", "ACTSEL's choices, exact inference", released, EXACT),
        Method("greedy-scored-actsel", "exact greedy's choices, ACTSEL's inference", greedy, RELEASED),
        RANDOM,
        Method("rand-scored-actsel", "five balanced orders, ACTSEL's inference", BalancedOrders(), RELEASED),
    )


def methods_on_costs() -> tuple[Method, ...]:
    """The methods that are compared where costs matter."""
    return (*few_methods()[:4], RANDOM, PER_COST, TWO_AHEAD)


def all_methods() -> tuple[Method, ...]:
    """All methods that are compared."""
    greedy, best = ByPolicy(EXACT, Greedy()), ByPolicy(BEST, Greedy())
    return (
        *few_methods(),
        PER_COST,
        TWO_AHEAD,
        Method("static", "best set of each size, exact inference", StaticSets(), EXACT),
        Method("actsel-repaired", "ACTSEL repaired", ByPolicy(REPAIRED, Greedy()), REPAIRED),
        Method("actsel-as-written", "ACTSEL as written", ByPolicy(WRITTEN, Greedy()), WRITTEN),
        Method("best-case-scored-exact", "ACTSEL's best case's choices, exact inference", best, EXACT),
        Method("greedy-scored-best-case", "exact greedy's choices, best case's inference", greedy, BEST),
    )


@lru_cache(maxsize=16)
def best_sets(network: Network, objective: Learn, actions: tuple[str, ...]) -> tuple[tuple[str, ...], ...]:
    """For each number of actions, from none to all, those whose outcomes together tell most.

    Examples
    --------
    >>> import palpate
    >>> network = palpate.load_network("household-filled")
    >>> best_sets(network, Learn("category"), ("cat-vision", "mat-vision"))
    ((), ('cat-vision',), ('cat-vision', 'mat-vision'))
    """
    plans = foresight(ExactBelief(network), objective, actions, repeat=False)
    sizes = range(1, len(actions))
    return ((), *(max(combinations(actions, size), key=plans.together) for size in sizes), actions)
