"""Outcomes: what an action returned, as small frozen records.

Three kinds are for categorical sensors and are never mixed up: a `Label` goes through the
sensor's confusion matrix, a `Likelihood` is used as it is, a `Posterior` is divided by the prior
its classifier was trained with. Three are for sensors of a number: a `Reading`, and `Above` or
`Below` a bound. `Failed` is for both.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

__all__ = ["Above", "Below", "Failed", "Label", "Likelihood", "Outcome", "Posterior", "Reading"]


@dataclass(frozen=True, slots=True)
class Label:
    """One of the sensor's outcomes, read through its confusion matrix."""

    label: str


@dataclass(frozen=True, slots=True)
class Likelihood:
    """p(outcome | state) up to a factor, for every state of the property."""

    values: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Posterior:
    """A classifier's probabilities over labels, and what is known of the classifier.

    Parameters
    ----------
    probabilities
        Label to probability; labels the network does not know are spread (see `palpate.network.vectors`).
    training_prior
        State to probability in the classifier's training data; uniform where it is None.
    temperature
        Calibration of the classifier: its probabilities are raised to 1 / temperature.
    """

    probabilities: Mapping[str, float]
    training_prior: Mapping[str, float] | None = None
    temperature: float = 1.0


@dataclass(frozen=True, slots=True)
class Reading:
    """A number; `sd` replaces the sensor's noise, `unit` is the property's where it is None."""

    value: float
    sd: float | None = None
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class Above:
    """All that is known of the reading is that it lies above `bound`."""

    bound: float
    sd: float | None = None
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class Below:
    """All that is known of the reading is that it lies below `bound`."""

    bound: float
    sd: float | None = None
    unit: str | None = None


@dataclass(frozen=True, slots=True)
class Failed:
    """The action gave nothing: the belief stays as it is, the cost is paid."""

    reason: str = ""


Outcome = Label | Likelihood | Posterior | Reading | Above | Below | Failed
