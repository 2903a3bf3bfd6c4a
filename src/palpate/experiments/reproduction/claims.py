"""The paper's claims, each checked on the table of steps, engine by engine."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.experiments.frames import Frame
from palpate.experiments.reproduction.paper import Claim
from palpate.experiments.reproduction.tasks import GREEDY, RANDOM, START
from palpate.experiments.reproduction.verdict import Finding, Verdict
from palpate.experiments.statistics import contrast, object_means

__all__ = ["CHECKS", "check", "verdicts"]

ABOUT_HALF = (1 / 3, 2 / 3)
"""Shares that count as about half."""
AT_START = ("no-negative-gain",)
"""Kinds of claims for which an engine need not be run."""
ROUNDING = 1e-9
"""A change of an entropy within this is none [bits]."""


def verdicts(steps: Frame, claims: Sequence[Claim]) -> list[Verdict]:
    """Check the claims on the steps of one network.

    Claims about objectives that are not in the table are left out, and so are engines that were not
    run, but of claims about gains before any action.
    """
    engines = {engine: steps.where(engine=engine) for engine in steps.unique("engine")}
    run = {engine: own for engine, own in engines.items() if set(own.unique("arm")) != {START}}
    known = set(steps.unique("objective"))
    return [
        Verdict(claim, {e: check(own, claim) for e, own in (engines if claim.kind in AT_START else run).items()})
        for claim in claims
        if set(claim.objectives) <= known
    ]


def check(steps: Frame, claim: Claim) -> Finding:
    """Check a claim on the steps of one network and engine."""
    chosen = steps.rows(np.isin(steps["objective"].astype(str), claim.objectives))
    return CHECKS[claim.kind](chosen, claim)


def _share(count: int, of: int, what: str = "runs") -> str:
    return f"{count} of {of} {what}" + (f" ({count / of:.0%})" if of else "")


def _all_take(rows: Frame, action: str) -> Finding:
    """Whether the action of all rows is this one."""
    counts = Counter(rows["action"].tolist())
    others = ", ".join(f"{name} {count}" for name, count in counts.most_common() if name != action)
    figure = _share(counts[action], len(rows)) + (f"; {others}" if others else "")
    return Finding(counts[action] == len(rows) if len(rows) else None, figure)


def _first(steps: Frame, claim: Claim) -> Finding:
    return _all_take(steps.where(arm=GREEDY, step=1), claim.action)


def _second(steps: Frame, claim: Claim) -> Finding:
    return _all_take(steps.where(arm=GREEDY, step=2, stopped=False), claim.action)


def _stops_after_first(steps: Frame, claim: Claim) -> Finding:
    rows = steps.where(arm=GREEDY, step=1, stopped=False)
    count = sum(stop is not None for stop in rows["stop"])
    low, high = (share * len(rows) for share in ABOUT_HALF)
    return Finding(low <= count <= high if len(rows) else None, _share(count, len(rows)))


def _all_taken(steps: Frame, claim: Claim) -> Finding:
    runs = steps.where(arm=GREEDY)
    last = runs.rows(np.append(runs["step"][1:] == 0, True) if len(runs) else np.zeros(0, dtype=bool))
    count = int((~last["stopped"].astype(bool)).sum())
    return Finding(2 * count > len(last) if len(last) else None, _share(count, len(last)))


def _mean_entropies(steps: Frame) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Mean entropy of the greedy and of the random choices, by step from 0 on [bits]."""
    greedy, chance = (steps.where(arm=arm).means("entropy_bits", "step") for arm in (GREEDY, RANDOM))
    order = sorted(set(greedy) & set(chance))
    return np.array([greedy[step] for step in order]), np.array([chance[step] for step in order])


def _entropy_below_random(steps: Frame, claim: Claim) -> Finding:
    greedy, chance = _mean_entropies(steps)
    # before the first action and after the last one both have the same outcomes
    inner = slice(1, max(2, len(greedy) - 1))
    figure = ", ".join(f"{a:.2f} / {b:.2f}" for a, b in zip(greedy[inner], chance[inner], strict=True))
    return Finding(bool((greedy[inner] < chance[inner]).all()), f"{figure} bits after action 1, 2, ...")


def _falls_most_first(steps: Frame, claim: Claim) -> Finding:
    falls = -np.diff(_mean_entropies(steps)[0])
    figure = ", ".join(f"{fall:.2f}" for fall in falls)
    return Finding(bool(len(falls)) and int(falls.argmax()) == 0, f"falls by {figure} bits")


def _cross_entropy_below_random(steps: Frame, claim: Claim) -> Finding:
    later = steps.rows(steps["step"] > 0)
    column = f"cross_entropy_{claim.objectives[0]}_bits"
    means = [object_means(own["object"].tolist(), own[column].astype(float)) for own in _arms(later)]
    found = contrast(claim.text, means[0], means[1])
    figure = (
        f"{np.mean(list(means[0].values())):.2f} / {np.mean(list(means[1].values())):.2f} bits, difference "
        f"{found.mean:+.2f} [{found.low:+.2f}, {found.high:+.2f}], p = {found.p:.2g}, {found.objects} objects"
    )
    return Finding(found.mean < 0, figure, chance=found.low <= 0 <= found.high)


def _arms(steps: Frame) -> tuple[Frame, Frame]:
    return steps.where(arm=GREEDY), steps.where(arm=RANDOM)


def _entropy_rises(steps: Frame, claim: Claim) -> Finding:
    further = steps.where(arm=GREEDY)
    further = further.rows(further["step"] > 1)
    count = int((further["entropy_drop_bits"].astype(float) < -ROUNDING).sum())
    return Finding(count > 0, _share(count, len(further), "further measurements"))


def _no_negative_gain(steps: Frame, claim: Claim) -> Finding:
    start, lowest = steps.where(step=0), {}
    for objective in start.unique("objective"):
        own = start.where(objective=objective)
        for column in (name for name in own.names if name.startswith("gain_")):
            action = column.removeprefix("gain_").removesuffix("_bits")
            lowest[action, objective] = float(own[column].astype(float).mean())
    negative = [f"{action} on {objective} {bits:+.2f}" for (action, objective), bits in lowest.items() if bits < 0]
    return Finding(not negative, "; ".join(negative) or f"lowest {min(lowest.values()):+.2f} bits")


CHECKS: Mapping[str, Callable[[Frame, Claim], Finding]] = {
    "first": _first,
    "second": _second,
    "stops-after-first": _stops_after_first,
    "all-taken": _all_taken,
    "entropy-below-random": _entropy_below_random,
    "falls-most-first": _falls_most_first,
    "cross-entropy-below-random": _cross_entropy_below_random,
    "entropy-rises": _entropy_rises,
    "no-negative-gain": _no_negative_gain,
}
"""Kind of claim to its check."""
