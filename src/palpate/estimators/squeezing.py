"""Squeezing: how force grows as the gap closes gives Young's modulus.

F = k max(0, g0 - g) + F0: contact point g0 and stiffness k are found together, as a threshold on force misses the
contact with soft objects. E = k L / A with rest width L and contact area A. The gap comes in steps of the gripper's
position sensor: an error in it counts k times as much as one in the force, so that both are weighed (Deming, 1943).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.estimators.contact import SURE_SDS, check_contact, check_end, check_growth, check_width
from palpate.estimators.forces import check_slip, drift_before, uncut
from palpate.estimators.hinge import Hinge, fit_hinge, scatter
from palpate.estimators.jaws import ForceCalibration, Jaws
from palpate.estimators.signals import SignalError, samples, together
from palpate.outcomes import Above, Failed, Reading

__all__ = ["ForceCalibration", "Jaws", "Squeeze", "squeeze"]

LEAST_SAMPLES = 8
LEAST_EXPLAINED = 0.8
"""Share of the force's variance in contact that the line must explain."""
ONSET = 0.1
"""Share of the greatest force at which the jaws touch for certain."""


@dataclass(frozen=True)
class Squeeze:
    """What a squeeze gave.

    Attributes
    ----------
    outcome
        Young's modulus in kPa with its SD, `Above` the limit, or why there is none.
    modulus_kpa, sd_kpa
        Young's modulus and its SD [kPa], also where they are above the limit; NaN where no line could be fitted.
    hinge
        The fitted line; None where nothing could be fitted.
    explained
        Share of the force's variance in contact that it explains.
    """

    outcome: Reading | Above | Failed
    modulus_kpa: float = float("nan")
    sd_kpa: float = float("nan")
    hinge: Hinge | None = None
    explained: float = float("nan")


def squeeze(gap_mm: ArrayLike, force_n: ArrayLike, jaws: Jaws) -> Squeeze:
    """Estimate Young's modulus from one closing of the jaws.

    Parameters
    ----------
    gap_mm, force_n
        Distance of the jaws [mm] and force between them [N], sample by sample in the order of time, (n).
    jaws
        Contact area, rest width, limit and noise.

    Raises
    ------
    EstimatorError
        If the two are not of one length.

    Examples
    --------
    >>> gap = np.linspace(60, 40, 80)
    >>> force = 0.9 * np.maximum(0, 52 - gap) + np.random.default_rng(0).normal(0, 0.05, 80)
    >>> found = squeeze(gap, force, Jaws(area_mm2=1200.0, width_mm=52.0, gap_sd_mm=0.01))
    >>> abs(found.modulus_kpa - 39) < 3 * found.sd_kpa < 1.5
    True
    """
    try:
        gap = samples("gap_mm", gap_mm, at_least=LEAST_SAMPLES)
        force = samples("force_n", force_n, at_least=LEAST_SAMPLES)
        together(gap_mm=gap, force_n=force)
        return _squeezed(gap, force, jaws)
    except SignalError as error:
        return Squeeze(Failed(str(error)))


def _squeezed(gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> Squeeze:
    if np.ptp(force) == 0:
        raise SignalError(f"force_n: all {force.size} samples are {force[0]:g}: no contact, or the sensor is silent")
    if np.ptp(gap) == 0:
        raise SignalError(f"gap_mm: all {gap.size} samples are {gap[0]:g}: the jaws did not move")
    gap, force = _closing(gap, force)
    check_slip(gap, force)
    check_end(gap, force, jaws)
    if _least_modulus_kpa(gap, force, jaws) > jaws.limit_kpa:
        return Squeeze(Above(jaws.limit_kpa, unit="kPa"))
    whole = uncut(force)
    if whole < LEAST_SAMPLES:
        raise SignalError(f"force_n: only {whole} samples before it is cut off, {LEAST_SAMPLES} are needed")
    gap, force = gap[:whole], force[:whole]
    hinge, force = _fit(gap, force, jaws)
    check_contact(hinge, gap, force, jaws)
    explained = hinge.explained(gap, force)
    if explained < LEAST_EXPLAINED:
        told = f"a line explains {explained:.0%} of the force in contact, expected {LEAST_EXPLAINED:.0%} at least"
        return Squeeze(Failed(f"poor fit: {told}"), hinge=hinge, explained=explained)
    check_growth(hinge, gap, force, jaws)
    width = hinge.contact if jaws.width_mm is None else jaws.width_mm
    # N/mm2 is MPa
    modulus = 1e3 * hinge.slope * width / jaws.area_mm2
    relative = hinge.relative_sd if jaws.width_mm is not None else hinge.relative_sd_of_product
    sd = modulus * float(np.hypot(relative, jaws.relative_sd))
    above = modulus > jaws.limit_kpa
    outcome = Above(jaws.limit_kpa, unit="kPa") if above else Reading(modulus, sd, "kPa")
    return Squeeze(outcome, modulus, sd, hinge, explained)


def _fit(gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> tuple[Hinge, NDArray[np.float64]]:
    """The line, and the force less the drift that it is seen to have before contact."""
    drift, sd = drift_before(gap, force)
    force = force - drift * np.arange(force.size)
    hinge = fit_hinge(gap, force, gap_sd=jaws.gap_sd_mm, force_sd=jaws.force_sd_n)
    if drift == 0:
        return hinge, force
    inside = gap < hinge.contact
    pace = float(np.ptp(gap[inside])) / max(int(np.count_nonzero(inside)) - 1, 1) if inside.any() else 0.0
    covariance = hinge.covariance.copy()
    covariance[1, 1] += (sd / pace) ** 2 if pace > 0 else 0.0
    return replace(hinge, covariance=covariance), force


def _closing(gap: NDArray[np.float64], force: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The part until the gap is smallest for the first time: what opens again says something else (hysteresis)."""
    end = int(np.argmin(gap)) + 1
    # where the jaws rest at the end, all of the rest counts
    end += int(np.argmax(np.append(gap[end:], np.inf) > gap[end - 1]))
    if end < LEAST_SAMPLES:
        raise SignalError(f"gap_mm: the jaws close during {end} samples only, {LEAST_SAMPLES} are needed")
    return gap[:end], force[:end]


def _least_modulus_kpa(gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> float:
    """What Young's modulus is at least where the jaws rest on the object while the force grows; 0 where they do not.

    The gap changes by no more than what was read and an error at both ends: where that is nearly nothing no line can
    be fitted, and yet the object is stiff beyond doubt.
    """
    idle, noise = float(np.median(force[: max(LEAST_SAMPLES // 2, force.size // 4)])), scatter(force)
    height = float(np.median(force[-3:])) - idle
    if height < 4 * SURE_SDS * noise or np.any(force[-LEAST_SAMPLES // 2 :] - idle < height / 2):
        return 0.0
    first = int(np.argmax(force - idle >= ONSET * height))
    closed = float(gap[first] - gap.min()) + 2 * SURE_SDS * jaws.gap_sd_mm
    width = jaws.width_mm if jaws.width_mm is not None else float(gap.min())
    least = 1e3 * (1 - ONSET) * height / max(closed, 1e-9) * width / jaws.area_mm2
    if least > jaws.limit_kpa:
        check_width(float(gap[first]), jaws)
    return least
