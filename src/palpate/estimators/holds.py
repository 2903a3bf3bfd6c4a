"""Holds: the torques of one joint at one pose, and what must be so for them to weigh anything."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.signals import EstimatorError, SignalError, samples, together

__all__ = ["CheckedHold", "Hold"]

LEAST_SAMPLES = 5
LONGEST_M = 10.0
LEFT_BY_STEP, STEP_SDS = 0.5, 6.0
"""A hold steps where two levels leave this share of the squares that a line leaves, and differ by so many SDs."""


@dataclass(frozen=True, eq=False)
class Hold:
    """Torques of one joint at one pose, with the object and without.

    Attributes
    ----------
    torque_nm, empty_torque_nm
        Samples [Nm], (n,) and (k,): while the object is held, and at the same pose with the empty, closed gripper.
    lever_m
        Horizontal distance [m] of the nominal grasp from the joint's axis; its sign says which way the torque goes.
    time_s, empty_time_s
        When the samples were taken [s], on one clock for all holds; needed where drift is estimated.
    lever_per_offset
        By how much the lever changes with the offset of the grasp along the gripper's axis; the cosine of the angle
        between that axis and the horizontal.
    joint
        Joints drift each for itself.
    """

    torque_nm: NDArray[np.float64]
    empty_torque_nm: NDArray[np.float64]
    lever_m: float
    time_s: NDArray[np.float64] | None = None
    empty_time_s: NDArray[np.float64] | None = None
    lever_per_offset: float = 1.0
    joint: str = ""


@dataclass(frozen=True, eq=False)
class CheckedHold:
    """A hold that was checked."""

    full: NDArray[np.float64]
    empty: NDArray[np.float64]
    full_s: NDArray[np.float64]
    empty_s: NDArray[np.float64]
    lever_m: float
    per_offset: float
    joint: str

    @classmethod
    def of(cls, place: int, hold: Hold, drifts: bool, resolution_nm: float) -> CheckedHold:
        """Check the hold at a place among others.

        Raises
        ------
        EstimatorError
            If a lever or time stamps cannot be.
        SignalError
            If torques are too few, not finite, cut off or all the same, or step while the object is held.
        """
        where = f"holds[{place}]"
        # longer than any arm: the lever is in millimetres
        if not 1e-3 < abs(hold.lever_m) < LONGEST_M:
            raise EstimatorError(f"{where}.lever_m: found {hold.lever_m}, expected 0.001 to {LONGEST_M:g} metres")
        if not np.isfinite(hold.lever_per_offset):
            raise EstimatorError(f"{where}.lever_per_offset: found {hold.lever_per_offset}, expected a finite number")
        full = samples(f"{where}.torque_nm", hold.torque_nm, at_least=LEAST_SAMPLES, may_clip=False)
        empty = samples(f"{where}.empty_torque_nm", hold.empty_torque_nm, at_least=LEAST_SAMPLES, may_clip=False)
        if np.ptp(full) == 0.0:
            raise SignalError(f"{where}.torque_nm: all {full.size} samples are {full[0]:g}: the sensor does not answer")
        _check_steady(f"{where}.torque_nm", full, resolution_nm)
        full_s = _stamps(f"{where}.time_s", hold.time_s, full, drifts)
        empty_s = _stamps(f"{where}.empty_time_s", hold.empty_time_s, empty, drifts)
        return cls(full, empty, full_s, empty_s, hold.lever_m, hold.lever_per_offset, hold.joint)


def _stamps(
    where: str, given: NDArray[np.float64] | None, values: NDArray[np.float64], drifts: bool
) -> NDArray[np.float64]:
    if given is None:
        if drifts:
            raise EstimatorError(f"{where}: is not given, expected time stamps where drift is estimated")
        return np.zeros(values.size)
    found = samples(where, given)
    together(**{where: found, where.replace("time_s", "torque_nm"): values})
    return found


def _check_steady(where: str, values: NDArray[np.float64], resolution_nm: float) -> None:
    """Refuse a hold whose level steps: two levels explain it far better than a line does."""
    count = values.size
    if count < 2 * LEAST_SAMPLES:
        return
    before = np.arange(LEAST_SAMPLES, count - LEAST_SAMPLES + 1)
    sums, squares = np.cumsum(values - values.mean()), float(np.sum((values - values.mean()) ** 2))
    # the sum is zero: (sum before)^2 / n_before + (sum after)^2 / n_after is what the two levels explain
    explained = sums[before - 1] ** 2 * (1 / before + 1 / (count - before))
    best = int(np.argmax(explained))
    left = squares - float(explained[best])
    line = np.polynomial.Polynomial.fit(np.arange(count), values, 1)
    of_line = float(np.sum((values - line(np.arange(count))) ** 2))
    step = float(values[before[best] :].mean() - values[: before[best]].mean())
    noise = np.sqrt(max(left, 0.0) / (count - 2))
    least = max(STEP_SDS * noise / np.sqrt(LEAST_SAMPLES), resolution_nm)
    if left < LEFT_BY_STEP * of_line and abs(step) > least:
        raise SignalError(f"{where}: the torque steps by {step:+.3g} Nm while the object is held: it slipped or fell")
