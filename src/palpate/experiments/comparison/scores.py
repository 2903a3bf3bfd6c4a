"""The score of one belief of one object, as columns of a tidy row."""

from __future__ import annotations

from collections.abc import Mapping

from palpate.experiments.measures import brier, cross_entropy_bits, crps
from palpate.experiments.running import Row
from palpate.inference.belief import Belief
from palpate.inference.marginals import CategoricalMarginal, ContinuousMarginal

__all__ = ["scores"]


def scores(belief: Belief, truth: Mapping[str, str | float]) -> Row:
    """Every measure of every property, in columns such as ``material_brier``; None where the truth is not known.

    Of categorical properties: cross_entropy_bits, brier, correct (1 where the most probable state is
    the true one), confidence (its probability), entropy_bits, probabilities (a list) and truth (an
    index). Of continuous ones: crps, rank (the probability below the truth), mean and sd.

    Examples
    --------
    >>> import palpate
    >>> row = scores(palpate.ExactBelief(palpate.load_network("household")), {"category": "mug"})
    >>> round(row["category_cross_entropy_bits"], 3), row["volume_crps"]
    (3.322, None)
    """
    row: Row = {}
    for name in belief.network.properties:
        marginal, true = belief.marginal(name), truth.get(name)
        found = _states(marginal, true) if isinstance(marginal, CategoricalMarginal) else _number(marginal, true)
        row |= {f"{name}_{measure}": value for measure, value in found.items()}
    return row


def _states(marginal: CategoricalMarginal, true: str | float | None) -> Row:
    p = marginal.probabilities
    truth = None if true is None else marginal.states.index(str(true))
    return {
        "cross_entropy_bits": None if truth is None else cross_entropy_bits(p, truth),
        "brier": None if truth is None else brier(p, truth),
        "correct": None if truth is None else float(p.argmax() == truth),
        "confidence": float(p.max()),
        "entropy_bits": marginal.entropy_bits,
        "truth": truth,
        "probabilities": p.tolist(),
    }


def _number(marginal: ContinuousMarginal, true: str | float | None) -> Row:
    if not marginal.nodes.size:  # the engine says nothing of it
        return dict.fromkeys(("crps", "rank", "mean", "sd"))
    return {
        "crps": None if true is None else crps(marginal, float(true)),
        "rank": None if true is None else marginal.cdf(float(true)),
        "mean": marginal.mean,
        "sd": marginal.sd,
    }
