"""Numbers and outcomes in few words, for pictures, pages and the terminal."""

from __future__ import annotations

import math
from collections.abc import Mapping

from palpate.errors import plural
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading

__all__ = ["number", "outcome_words", "plural"]


def number(value: float | None, digits: int = 3) -> str:
    """Write a number with `digits` significant digits, without an exponent where it reads well.

    Examples
    --------
    >>> number(41.2345), number(0.0031234), number(2512.3), number(1.5e9), number(None)
    ('41.2', '0.00312', '2512', '1.5e+09', '-')
    """
    if value is None or math.isnan(value):
        return "-"
    if value == 0 or math.isinf(value):
        return f"{value:g}"
    exponent = math.floor(math.log10(abs(value)))
    if -5 <= exponent < 7:
        return f"{value:.{max(0, digits - 1 - exponent)}f}"
    return f"{value:.{digits}g}"


def outcome_words(outcome: Outcome, unit: str = "") -> str:
    """Say what an action returned, a reading with its own SD where it has one.

    Parameters
    ----------
    unit
        Of a number that has none of its own.

    Examples
    --------
    >>> outcome_words(Reading(118.0), "g"), outcome_words(Reading(118.0, 5.3), "g")
    ('118 g', '118 ± 5.3 g')
    >>> outcome_words(Posterior({"kettle": 0.576, "fruit": 0.3, "mug": 0.124}))
    'posterior: kettle 0.58, fruit 0.30, ...'
    """
    match outcome:
        case Label(label):
            return label
        case Likelihood(values):
            return f"likelihood: {_top(values)}"
        case Posterior(probabilities):
            return f"posterior: {_top(probabilities)}"
        case Reading(value, sd, own):
            spread = "" if sd is None else f" ± {number(sd, 2)}"
            return f"{number(value)}{spread} {own or unit}".rstrip()
        case Above(bound, unit=own):
            return f"above {number(bound)} {own or unit}".rstrip()
        case Below(bound, unit=own):
            return f"below {number(bound)} {own or unit}".rstrip()
        case Failed(reason):
            return f"failed: {reason}" if reason else "failed"


def _top(weights: Mapping[str, float], most: int = 2) -> str:
    ranked = sorted(weights.items(), key=lambda item: -item[1])
    shown = ", ".join(f"{name} {number(weight, 2)}" for name, weight in ranked[:most])
    return f"{shown}, ..." if len(ranked) > most else shown
