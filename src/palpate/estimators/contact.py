"""Whether the jaws squeeze the object: what the force and the gap say of contact, and of where it ends."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.hinge import Hinge
from palpate.estimators.jaws import Jaws
from palpate.estimators.signals import LEAST_CLIPPED, SignalError, check_clipping

__all__ = ["SURE_SDS", "check_contact", "check_end", "check_growth", "check_width"]

SURE_SDS = 5.0
"""A slope of so many of its SDs is contact."""
BENT_SDS, BENT_AT_WIDTH_SDS = 3.0, 2.0
"""Where a line does as well as one with a beginning, to so many SDs, the beginning is not seen; a known width helps."""
OFF_SHARE, OFF_MM = 0.2, 4.0
"""Jaws that first touch further from the known width than this share of it, or so many mm, touch something else."""
LEAST_WIDTH_MM = 3.0
"""What is thinner than this is the other jaw."""
FLAT, LAST, LEAST_LAST = 0.5, (3, 5, 8, 12), 4
"""The force has stopped growing where it grows by less than this share of its slope in the last third of the way, or
in the last fifth, and so on, and so many samples are there."""


def check_width(contact_mm: float, jaws: Jaws, sd_mm: float = 0.0) -> None:
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


def check_contact(hinge: Hinge, gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> None:
    """Refuse a line without contact: a force that does not grow, or of which nobody can see where it begins."""
    if hinge.slope < SURE_SDS * hinge.slope_sd or np.ptp(force) < SURE_SDS * hinge.noise_sd:
        raise SignalError("no contact: the force does not grow as the gap closes")
    if np.count_nonzero(gap < hinge.contact) < 3:
        raise SignalError("no contact: fewer than three samples are closer than the contact point")
    line = np.polynomial.Polynomial.fit(gap, force, 1)
    left, of_line = (float(np.sum((force - fitted) ** 2)) for fitted in (hinge.at(gap), line(gap)))
    sure = BENT_SDS if jaws.width_mm is None else BENT_AT_WIDTH_SDS
    if of_line - left < sure**2 * left / max(force.size - 3, 1):
        raise SignalError("no contact: the force grows all along, so that where it begins is not seen")
    check_width(hinge.contact, jaws, min(float(np.sqrt(hinge.covariance[0, 0])), OFF_MM / SURE_SDS))


def check_end(gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> None:
    """Refuse a force that is cut off while the jaws close; where they rest it may well stay the same."""
    top = gap[force == force.max()]
    if top.size >= LEAST_CLIPPED and np.ptp(top) > 2 * SURE_SDS * jaws.gap_sd_mm:
        check_clipping("force_n", force)


def check_growth(hinge: Hinge, gap: NDArray[np.float64], force: NDArray[np.float64], jaws: Jaws) -> None:
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
