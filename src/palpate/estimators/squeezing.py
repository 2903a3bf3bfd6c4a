"""Squeezing: how force grows as the gap closes gives Young's modulus.

F = k max(0, g0 - g) + F0: contact point g0 and stiffness k are found together, as a threshold on force misses the
contact with soft objects. E = k L / A with rest width L and contact area A. The gap comes in steps of the gripper's
position sensor: an error in it counts k times as much as one in the force, so that both are weighed (Deming, 1943).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.estimators.forces import check_slip, drift_before, uncut
from palpate.estimators.hinge import Hinge, fit_hinge, scatter
from palpate.estimators.signals import LEAST_CLIPPED, EstimatorError, SignalError, check_clipping, samples, together
from palpate.outcomes import Above, Failed, Reading

__all__ = ["ForceCalibration", "Jaws", "Squeeze", "squeeze"]

LEAST_SAMPLES = 8
SURE_SDS = 5.0
"""A slope of so many of its SDs is contact."""
BENT_SDS, BENT_AT_WIDTH_SDS = 3.0, 2.0
"""Where a line does as well as one with a beginning, to so many SDs, the beginning is not seen; a known width helps."""
LEAST_EXPLAINED = 0.8
"""Share of the force's variance in contact that the line must explain."""
ONSET = 0.1
"""Share of the greatest force at which the jaws touch for certain."""
OFF_SHARE, OFF_MM = 0.2, 4.0
"""Jaws that first touch further from the known width than this share of it, or so many mm, touch something else."""
LEAST_WIDTH_MM = 3.0
"""What is thinner than this is the other jaw."""
FLAT, LAST, LEAST_LAST = 0.5, (3, 5, 8, 12), 4
"""The force has stopped growing where it grows by less than this share of its slope in the last third of the way, or
in the last fifth, and so on, and so many samples are there."""


@dataclass(frozen=True)
class ForceCalibration:
    """From the motor's current to the force of the jaws, as measured on known springs."""

    newton_per_ampere: float
    idle_current_a: float = 0.0

    def force_n(self, current_a: ArrayLike) -> NDArray[np.float64]:
        """Force [N] at a current [A], (n).

        Examples
        --------
        >>> ForceCalibration(100.0, idle_current_a=0.05).force_n([0.05, 0.25])
        array([ 0., 20.])
        """
        return (np.asarray(current_a, dtype=np.float64) - self.idle_current_a) * self.newton_per_ampere


@dataclass(frozen=True)
class Jaws:
    """What is known of the gripper and of how it touches the object.

    Attributes
    ----------
    area_mm2
        Contact area of a jaw and the object [mm2].
    width_mm
        The object's width at rest [mm]; the gap at contact where it is None.
    limit_kpa
        Readings above it are only known to be above: the gripper yields before the object does.
    gap_sd_mm
        SD of the gap's error [mm]; a step of 0.37 mm has one of 0.37 / sqrt(12).
    force_sd_n
        SD of the force's noise [N]; taken from the scatter where it is None.
    relative_sd
        Relative SD of the contact area over the width: what no squeeze can tell.
    """

    area_mm2: float
    width_mm: float | None = None
    limit_kpa: float = 95.0
    gap_sd_mm: float = 0.37 / 12**0.5
    force_sd_n: float | None = None
    relative_sd: float = 0.0

    def __post_init__(self) -> None:
        for name in ("area_mm2", "limit_kpa", "width_mm", "force_sd_n"):
            value = getattr(self, name)
            if value is not None and not 0 < value < np.inf:
                raise EstimatorError(f"{name}: found {value}, expected a number above zero")
        for name in ("gap_sd_mm", "relative_sd"):
            if not 0 <= getattr(self, name) < np.inf:
                raise EstimatorError(f"{name}: found {getattr(self, name)}, expected a number of zero or more")


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
    _check_end(gap, force, jaws)
    if _least_modulus_kpa(gap, force, jaws) > jaws.limit_kpa:
        return Squeeze(Above(jaws.limit_kpa, unit="kPa"))
    whole = uncut(force)
    if whole < LEAST_SAMPLES:
        raise SignalError(f"force_n: only {whole} samples before it is cut off, {LEAST_SAMPLES} are needed")
    gap, force = gap[:whole], force[:whole]
    hinge, force = _fit(gap, force, jaws)
    _check_contact(hinge, gap, force, jaws)
    explained = hinge.explained(gap, force)
    if explained < LEAST_EXPLAINED:
        told = f"a line explains {explained:.0%} of the force in contact, expected {LEAST_EXPLAINED:.0%} at least"
        return Squeeze(Failed(f"poor fit: {told}"), hinge=hinge, explained=explained)
    _check_growth(hinge, gap, force, jaws)
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
        _check_width(float(gap[first]), jaws)
    return least


def _check_width(contact_mm: float, jaws: Jaws, sd_mm: float = 0.0) -> None:
    """Refuse a contact that is not with the object: a miss, a gap in other units, a force that wanders."""
    if contact_mm < LEAST_WIDTH_MM:
        raise SignalError(f"no contact: the force begins at a gap of {contact_mm:.3g} mm, where the jaws meet")
    if jaws.width_mm is None:
        return
    if abs(contact_mm - jaws.width_mm) > max(OFF_SHARE * jaws.width_mm, OFF_MM) + SURE_SDS * sd_mm:
        raise SignalError(
            f"no contact with the object: the force begins at a gap of {contact_mm:.3g} mm, and it is "
            f"{jaws.width_mm:g} mm wide"
        )


def _check_contact(hinge: Hinge, gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> None:
    if hinge.slope < SURE_SDS * hinge.slope_sd or np.ptp(force) < SURE_SDS * hinge.noise_sd:
        raise SignalError("no contact: the force does not grow as the gap closes")
    if np.count_nonzero(gap < hinge.contact) < 3:
        raise SignalError("no contact: fewer than three samples are closer than the contact point")
    line = np.polynomial.Polynomial.fit(gap, force, 1)
    left, of_line = (float(np.sum((force - fitted) ** 2)) for fitted in (hinge.at(gap), line(gap)))
    sure = BENT_SDS if jaws.width_mm is None else BENT_AT_WIDTH_SDS
    if of_line - left < sure**2 * left / max(force.size - 3, 1):
        raise SignalError("no contact: the force grows all along, so that where it begins is not seen")
    _check_width(hinge.contact, jaws, min(float(np.sqrt(hinge.covariance[0, 0])), OFF_MM / SURE_SDS))


def _check_end(gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> None:
    """Refuse a force that is cut off while the jaws close; where they rest it may well stay the same."""
    top = gap[force == force.max()]
    if top.size >= LEAST_CLIPPED and np.ptp(top) > 2 * SURE_SDS * jaws.gap_sd_mm:
        check_clipping("force_n", force)


def _check_growth(hinge: Hinge, gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> None:
    """Refuse a force that stops growing while the jaws close: a sensor at its end, or an object that gave way."""
    inside = gap < hinge.contact
    for part in LAST:
        last = gap < hinge.contact - (1 - 1 / part) * (hinge.contact - gap.min())
        way = gap[last] - gap[last].mean()
        if way.size < LEAST_LAST or not way.any():
            return
        power = float(way @ way)
        slope = -float(way @ force[last]) / power
        sd = float(np.hypot(hinge.noise_sd, hinge.slope * jaws.gap_sd_mm)) / power**0.5
        sure = SURE_SDS * sd if not _lags(gap, force, inside & ~last, last, hinge, jaws) else sd
        if slope + sure < FLAT * hinge.slope:
            raise SignalError(
                f"poor fit: the force stops growing at {force[last].mean():.3g} N while the jaws close: the sensor is "
                "at its end, or the object gave way"
            )


def _lags(
    gap: NDArray[np.float64],
    force: NDArray[np.float64],
    before: NDArray[np.bool_],
    last: NDArray[np.bool_],
    hinge: Hinge,
    jaws: Jaws,
) -> bool:
    """Whether the last of the force is less, beyond doubt, than the line through what came before says."""
    way = gap[before] - gap[before].mean() if before.any() else np.zeros(0)
    if way.size < LEAST_LAST or not way.any():
        return False
    on = float(gap[last].mean() - gap[before].mean())
    power = float(way @ way)
    told = float(force[before].mean() + on * (way @ force[before]) / power)
    of_gap = hinge.slope * jaws.gap_sd_mm
    noise = float(np.hypot(hinge.noise_sd, of_gap)) * (1 / way.size + 1 / np.count_nonzero(last) + on**2 / power) ** 0.5
    # all of the last part may be within one step of the gap
    return told - float(force[last].mean()) > SURE_SDS * float(np.hypot(noise, of_gap))
