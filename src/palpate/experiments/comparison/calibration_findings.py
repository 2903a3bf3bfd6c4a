"""What many exact beliefs say of their own calibration, and whether that is as good as it should be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from palpate.experiments.comparison.results import Results
from palpate.experiments.measures import class_wise_ece, covered

__all__ = ["Check", "NumberCalibration", "StateCalibration", "checks", "numbers", "states"]

GAP_BITS, ECE, COVERAGE = 0.03, 0.01, 0.01
"""Largest differences that count as none."""


@dataclass(frozen=True)
class StateCalibration:
    """Of beliefs about a categorical property: means, and how far they are from what they should be."""

    name: str
    cross_entropy_bits: float
    entropy_bits: float
    accuracy: float
    confidence: float
    ece: float


@dataclass(frozen=True)
class NumberCalibration:
    """Of beliefs about a continuous property: share of truths in central intervals, and the mean score [unit]."""

    name: str
    within_50: float
    within_90: float
    crps: float


@dataclass(frozen=True)
class Check:
    """Something that exact beliefs must do where all is as believed."""

    words: str
    found: float
    wanted: str
    holds: bool


def states(own: Results) -> list[StateCalibration]:
    """A record for each categorical property of which truths are known."""
    found = []
    for name in own.categorical:
        p, truth, weights = own.stacked(name)
        if not len(p):
            continue
        measures = ("cross_entropy_bits", "entropy_bits", "correct", "confidence")
        bits, entropy, accuracy, confidence = (own.mean(own.numbers(f"{name}_{measure}")) for measure in measures)
        ece = class_wise_ece(p, truth, weights)
        found.append(StateCalibration(name, bits, entropy, accuracy, confidence, ece))
    return found


def numbers(own: Results) -> list[NumberCalibration]:
    """A record for each continuous property of which something is said."""
    found = []
    for name in own.continuous:
        rank = own.numbers(f"{name}_rank")
        if np.isnan(rank).all():
            continue
        half, most = (own.mean(covered(rank, level)) for level in (0.5, 0.9))
        found.append(NumberCalibration(name, half, most, own.mean(own.numbers(f"{name}_crps"))))
    return found


def checks(own: Results) -> list[Check]:
    """Every check, on objects drawn from the network that is believed."""
    found = []
    for one in states(own):
        gap = one.cross_entropy_bits - one.entropy_bits
        found.append(_check(f"{one.name}: excess of cross-entropy [bits]", gap, 0.0, GAP_BITS))
        found.append(_check(f"{one.name}: class-wise ECE", one.ece, 0.0, ECE))
    for each in numbers(own):
        found.append(_check(f"{each.name}: in the 50 % interval", each.within_50, 0.5, COVERAGE))
        found.append(_check(f"{each.name}: in the 90 % interval", each.within_90, 0.9, COVERAGE))
    return found


def _check(words: str, found: float, wanted: float, within: float) -> Check:
    return Check(words, found, f"{wanted:g} +- {within:g}", abs(found - wanted) <= within)
