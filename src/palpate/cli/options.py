"""Strings of the command line to objects; nothing behind this module sees the strings.

Lists are separated by commas, arguments by colons: ``--stop gain:0.05,entropy:material:0.5``,
``--policy fixed:weighing,squeezing``, ``--cost weighing=15``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence

from palpate.errors import PalpateError, choices, near
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.selection.objectives import Everything, Learn, Objective
from palpate.selection.policies import FixedOrder, Greedy, GreedyPerCost, Policy, Random
from palpate.selection.stopping import (
    AnyOf,
    CostBudget,
    EntropyBelow,
    GainBelow,
    NetGainBelow,
    NothingLeft,
    SdBelow,
    StepBudget,
    StoppingRule,
)

__all__ = ["costs", "number_of", "objective", "policy", "stopping", "stopping_words"]

POLICIES = ("greedy", "greedy-per-cost", "random", "fixed:ACTION,ACTION,...", "static:K", "look-ahead:N")
RULES = (
    "gain:BITS",
    "net-gain:BITS_PER_S",
    "entropy:PROPERTY:BITS",
    "sd:PROPERTY:SD",
    "cost:SECONDS",
    "steps:N",
    "nothing-left",
)
DEFAULT_RULE = "gain:0.05"


def number_of(option: str, text: str, *, least: float = 0.0) -> float:
    """A finite number of at least `least`."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not least <= value < math.inf:
        raise PalpateError(f"{option}: {text!r} was found, expected a finite number of at least {least:g}")
    return value


def _count(option: str, text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise PalpateError(f"{option}: {text!r} was found, expected a whole number of at least 1")
    return int(text)


def _listed(option: str, texts: Iterable[str]) -> list[str]:
    """The items of comma lists, one after the other; each list holds one at least."""
    items: list[str] = []
    for text in texts:
        found = [item.strip() for item in text.split(",") if item.strip()]
        if not found:
            raise PalpateError(f"{option}: {text!r} holds nothing, expected at least one item")
        items += found
    return items


def objective(network: Network, names: Sequence[str]) -> Objective:
    """``--learn``: properties to learn about together, or everything."""
    wanted = list(dict.fromkeys(_listed("--learn", names)))
    valid = [*network.properties, "everything"]
    for name in wanted:
        if name not in valid:
            raise PalpateError(f"--learn: unknown property {name!r}{near(name, valid)}; {choices(valid)}")
    return Learn(*wanted) if wanted and "everything" not in wanted else Everything()


def policy(network: Network, text: str) -> Policy:
    """``--policy``: how the next action is chosen."""
    kind, _, argument = text.partition(":")
    where = f"--policy {kind}"
    plain: Mapping[str, Callable[[], Policy]] = {"greedy": Greedy, "greedy-per-cost": GreedyPerCost, "random": Random}
    if kind in plain and not argument:
        return plain[kind]()
    if kind == "fixed" and argument:
        order = _listed(where, [argument])
        for action in order:
            _check_action(where, network, action)
        return FixedOrder(order)
    if kind == "static":
        from palpate.selection.static import StaticSet

        return StaticSet(_count(where, argument))
    if kind == "look-ahead":
        from palpate.selection.lookahead import LookAhead

        return LookAhead(_count(where, argument))
    raise PalpateError(f"--policy: {text!r} was found{_near_kind(kind, POLICIES)}; {choices(POLICIES)}")


def stopping_words(texts: Sequence[str], budget_s: float | None = None, steps: int | None = None) -> str:
    """The stopping rules as they could be typed after one ``--stop``."""
    rules = _listed("--stop", texts) or [DEFAULT_RULE]
    if budget_s is not None:
        rules.append(f"cost:{budget_s}")
    if steps is not None:
        rules.append(f"steps:{steps}")
    return ",".join(rules)


def stopping(
    network: Network, texts: Sequence[str], budget_s: float | None = None, steps: int | None = None
) -> StoppingRule:
    """``--stop``, ``--budget`` and ``--steps``: exploration stops as soon as one of them says so."""
    words = stopping_words(texts, budget_s, steps)
    rules = tuple(_rule(network, text) for text in words.split(","))
    return rules[0] if len(rules) == 1 else AnyOf(rules)


def _rule(network: Network, text: str) -> StoppingRule:
    kind, *arguments = text.split(":")
    where = f"--stop {text}"
    match kind, arguments:
        case "gain", [bits]:
            return GainBelow(number_of(where, bits))
        case "net-gain", [price]:
            return NetGainBelow(number_of(where, price))
        case "entropy", [name, bits]:
            return EntropyBelow(_property(where, network, name, categorical=True), number_of(where, bits))
        case "sd", [name, sd]:
            return SdBelow(_property(where, network, name, categorical=False), number_of(where, sd))
        case "cost", [seconds]:
            return CostBudget(number_of(where, seconds))
        case "steps", [count]:
            return StepBudget(_count(where, count))
        case "nothing-left", []:
            return NothingLeft()
    raise PalpateError(f"--stop: {text!r} was found{_near_kind(kind, RULES)}; {choices(RULES)}")


def costs(network: Network, texts: Sequence[str]) -> dict[str, float]:
    """``--cost action=seconds``: the cost of every action [s], the network's own unless given."""
    given: dict[str, float] = {}
    for text in _listed("--cost", texts):
        action, equals, seconds = text.partition("=")
        if not equals:
            raise PalpateError(f"--cost: {text!r} was found, expected ACTION=SECONDS")
        _check_action("--cost", network, action)
        if action in given:
            found = f"two costs, {given[action]:g} and {seconds}, were found"
            raise PalpateError(f"--cost {action}: {found}, expected one")
        given[action] = number_of(f"--cost {action}", seconds)
    return {name: action.cost_s for name, action in network.actions.items()} | given


def _check_action(where: str, network: Network, name: str) -> None:
    if name not in network.actions:
        hint = near(name, network.actions)
        raise PalpateError(f"{where}: unknown action {name!r}{hint}; {choices(network.actions)}")


def _near_kind(kind: str, forms: Iterable[str]) -> str:
    """The word that was probably meant, of those that stand before the colon."""
    return near(kind, (form.partition(":")[0] for form in forms))


def _property(where: str, network: Network, name: str, *, categorical: bool) -> str:
    """The name, where it is of a property of the right kind."""
    kinds = {p.name: isinstance(p, CategoricalProperty) for p in network.properties.values()}
    fitting = [known for known, is_categorical in kinds.items() if is_categorical == categorical]
    if name not in fitting:
        kind = "categorical" if categorical else "continuous"
        raise PalpateError(f"{where}: {name!r}{near(name, fitting)} is no {kind} property; {choices(fitting)}")
    return name
