"""Vectors of evidence over the states of a categorical property.

A likelihood is used as it is. A classifier's posterior becomes a likelihood in four steps:

1. mass on labels that are no states goes evenly to the states that hold less than
   `UNSEEN` after the known labels are assigned; if there are none it is dropped;
2. the probabilities are raised to 1 / temperature;
3. they are divided by the prior the classifier was trained with, uniform unless given;
4. they are scaled to a maximum of one and floored at `FLOOR`, as no classifier is that sure.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from palpate.errors import EvidenceError, choices, near
from palpate.network.properties import CategoricalProperty
from palpate.outcomes import Likelihood, Posterior

__all__ = ["FLOOR", "UNSEEN", "StateLikelihood", "admit_likelihood", "admit_posterior"]

FLOOR = 1e-3
UNSEEN = 1e-5
# Classifiers print their probabilities with few digits: a sum within this is a rounded one.
ROUNDING = 1e-4


@dataclass(frozen=True, slots=True, eq=False)
class StateLikelihood:
    """p(outcome | state) scaled to a maximum of one, an array in the order of the states."""

    values: NDArray[np.float64]


def admit_likelihood(where: str, measured: CategoricalProperty, outcome: Likelihood) -> StateLikelihood:
    """Check that every state is named, and scale to a maximum of one.

    Raises
    ------
    EvidenceError
        A state is missing or unknown, a number is negative or not finite, or all are zero.
    """
    values = _of_every_state(where, "likelihood", measured, outcome.values)
    if values.max() == 0:
        raise EvidenceError(f"{where}: likelihood is zero for every state, expected one above zero at least")
    return StateLikelihood(values / values.max())


def admit_posterior(
    where: str, measured: CategoricalProperty, outcome: Posterior
) -> tuple[StateLikelihood, tuple[str, ...]]:
    """Turn a classifier's posterior into a likelihood; the notices tell each decision.

    Raises
    ------
    EvidenceError
        A number is negative or not finite, all are zero, the temperature is not above zero, or
        the training prior does not name every state with a number above zero.

    Examples
    --------
    >>> import numpy as np
    >>> ware = CategoricalProperty("ware", ("mug", "box", "can"), (), np.full(3, 1 / 3))
    >>> likelihood, notices = admit_posterior("camera", ware, Posterior({"mug": 0.8, "kettle": 0.2}))
    >>> likelihood.values.round(3).tolist()
    [1.0, 0.125, 0.125]
    >>> notices[0]
    "camera: 0.2 on labels that are no states ('kettle') is spread evenly over 'box', 'can'"
    """
    temperature = _number(where, "temperature", outcome.temperature)
    if temperature == 0:
        raise EvidenceError(f"{where}: temperature 0 was found, expected a number above zero")
    notices: list[str] = []
    assigned = _assigned(where, measured.states, outcome.probabilities, notices)
    prior = _training_prior(where, measured, outcome.training_prior, notices)
    with np.errstate(divide="ignore"):
        log_likelihood = np.log(assigned) / temperature - np.log(prior)
    if temperature != 1:
        notices.append(f"{where}: the posterior is raised to 1 / {temperature:g}, its classifier's temperature")
    values = np.exp(log_likelihood - log_likelihood.max())
    floored = [state for state, value in zip(measured.states, values, strict=True) if value < FLOOR]
    if floored:
        notices.append(f"{where}: the likelihood of {_names(floored)} is raised to {FLOOR:g} of the largest")
    return StateLikelihood(np.maximum(values, FLOOR)), tuple(notices)


def _assigned(
    where: str, states: Sequence[str], probabilities: Mapping[str, float], notices: list[str]
) -> NDArray[np.float64]:
    """Step 1: probabilities of the states, summing to one."""
    found = {label: _number(where, f"posterior of {label!r}", value) for label, value in probabilities.items()}
    total = sum(found.values())
    if not 0 < total < math.inf:
        raise EvidenceError(f"{where}: the posterior sums to {total:g}, expected one")
    if abs(total - 1) > ROUNDING:
        notices.append(f"{where}: the posterior sums to {total:.6g} and is divided by it")
    values = np.array([found.get(state, 0.0) for state in states]) / total
    missing = [state for state in states if state not in found]
    unknown = {label: value / total for label, value in found.items() if label not in states and value > 0}
    if not unknown:
        if missing:
            notices.append(f"{where}: the posterior does not name {_names(missing)}, which count as zero")
        return values
    unseen = values < UNSEEN
    fate = "is dropped, as every state holds some of the rest"
    if unseen.any():
        values = values + unseen * sum(unknown.values()) / unseen.sum()
        fate = "is spread evenly over " + _names(s for s, empty in zip(states, unseen, strict=True) if empty)
    told = f"{sum(unknown.values()):.3g} on labels that are no states ({_names(unknown)})"
    notices.insert(0, f"{where}: {told} {fate}")
    return np.asarray(values / values.sum())


def _training_prior(
    where: str, measured: CategoricalProperty, given: Mapping[str, float] | None, notices: list[str]
) -> NDArray[np.float64]:
    if given is None:
        notices.append(f"{where}: no training prior is given, a uniform one is assumed")
        return np.ones(len(measured.states))
    prior = _of_every_state(where, "training prior", measured, given)
    if prior.min() == 0:
        state = measured.states[int(prior.argmin())]
        raise EvidenceError(f"{where}: training prior of {state!r} is 0, expected a number above zero for every state")
    return prior


def _of_every_state(
    where: str, what: str, measured: CategoricalProperty, given: Mapping[str, float]
) -> NDArray[np.float64]:
    for name in given:
        if name not in measured.states:
            hint = near(name, measured.states)
            raise EvidenceError(
                f"{where}: {what} names {name!r}{hint}, no state of {measured.name!r}; {choices(measured.states)}"
            )
    missing = [state for state in measured.states if state not in given]
    if missing:
        raise EvidenceError(
            f"{where}: {what} does not name {_names(missing)}, expected every state of {measured.name!r}"
        )
    return np.array([_number(where, f"{what} of {state!r}", given[state]) for state in measured.states])


def _number(where: str, what: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value) or value < 0:
        raise EvidenceError(f"{where}: {what} {value!r} was found, expected a finite number, zero or above")
    return float(value)


def _names(names: Iterable[str]) -> str:
    return ", ".join(repr(name) for name in names)
