"""Weighing: the torques that hold an object up, less those that hold the empty gripper up, give its mass.

At a pose with lever l, tau = m g l + tau0 + drift x t + noise. The grasp is off by an unknown length d, which changes
the lever by c d; d is normal about zero with a known SD. Mass, offsets and drift are estimated together by generalised
least squares; the SD of the mass takes in the noise, its correlation in time, and the grasp.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.holds import CheckedHold, Hold
from palpate.estimators.mass_equations import equations, least_squares
from palpate.estimators.signals import EstimatorError, SignalError
from palpate.outcomes import Failed, Reading

__all__ = ["PAYLOAD_KG", "Hold", "Weighing", "weigh"]

RESOLUTION_NM = 0.005
"""Of a good arm's torque sensors: about a gram at half a metre."""
PAYLOAD_KG = 4.5
"""The most that a Kinova Gen3 holds, and that for a moment (Gen3 user guide, normal use; 4 kg if it is held on)."""
BELOW_ZERO_SDS = 4.0
APART_SDS = 6.0
"""Joints that are further apart than this, or agree only about a grasp that is so far off, cannot all be right."""
ROUNDS = 3


@dataclass(frozen=True)
class Weighing:
    """What a weighing gave.

    Attributes
    ----------
    outcome
        The mass in g with its SD, or why there is none.
    mass_g, sd_g
        Mass and its SD [g]; NaN where the outcome is failed.
    noise_sd_g, grasp_sd_g
        What the noise of the torques and the unknown offset of the grasp contribute to the SD [g].
    drift_nm_per_s
        Joint to the drift of its torque.
    """

    outcome: Reading | Failed
    mass_g: float = float("nan")
    sd_g: float = float("nan")
    noise_sd_g: float = float("nan")
    grasp_sd_g: float = float("nan")
    drift_nm_per_s: dict[str, float] = field(default_factory=dict)


def weigh(
    holds: Sequence[Hold],
    *,
    grasp_sd_m: float = 0.006,
    drifts: bool = False,
    resolution_nm: float = RESOLUTION_NM,
    payload_kg: float = PAYLOAD_KG,
) -> Weighing:
    """Estimate the mass of what is held.

    Parameters
    ----------
    holds
        At least one; several poses whose levers change differently with the grasp tell its offset.
    grasp_sd_m
        SD [m] of the offset of the grasp; 6 mm, that of an even spread over +-10 mm, unless given.
    drifts
        Whether to estimate a drift of each joint, linear in time. The holds then need time stamps.
    resolution_nm
        What the torque sensors can tell [Nm]; a step that is smaller is no slip, however little noise there is.
    payload_kg
        The most that the arm can hold [kg]; infinity for an arm of which it is not known.

    Returns
    -------
    Weighing
        Failed where samples are too few, not finite or cut off, where the object slipped while it was held, where
        joints do not agree, or where the mass would be far below zero or above what the arm can hold.

    Raises
    ------
    EstimatorError
        If there is no hold, a lever is zero, a number is not finite, or time stamps are missing or do not fit.

    Examples
    --------
    >>> noise = np.random.default_rng(0).normal(0, 0.02, (2, 50))
    >>> found = weigh([Hold(noise[0] + 0.25 * 9.80665 * 0.4, noise[1], lever_m=0.4)])
    >>> abs(found.mass_g - 250) < 3 * found.sd_g < 15
    True
    """
    if not holds:
        raise EstimatorError("holds: found none, expected one at least")
    for name, value in (("grasp_sd_m", grasp_sd_m), ("resolution_nm", resolution_nm)):
        if not 0 <= value < np.inf:
            raise EstimatorError(f"{name}: found {value}, expected a number of 0 or more")
    if not payload_kg > 0:
        raise EstimatorError(f"payload_kg: found {payload_kg}, expected a number above 0")
    try:
        parts = [CheckedHold.of(place, hold, drifts, resolution_nm) for place, hold in enumerate(holds)]
        found = _solved(parts, grasp_sd_m, drifts, resolution_nm)
        if found.mass_g > 1e3 * payload_kg:
            raise SignalError(
                f"the mass would be {found.mass_g / 1e3:.3g} kg, and the arm can hold {payload_kg:g} kg: torques or "
                "levers are in another unit"
            )
        return found
    except SignalError as error:
        return Weighing(Failed(str(error)))


def _solved(parts: Sequence[CheckedHold], grasp_sd_m: float, drifts: bool, resolution_nm: float) -> Weighing:
    """Generalised least squares; the SD of the lever's change depends on the mass, so that is done again with it."""
    rows, torques, variances = equations(parts, drifts)
    weights = 1 / np.sqrt(variances)
    alone = least_squares(np.delete(rows, 1, axis=1) * weights[:, None], torques * weights)
    mass_kg, covariance, solution = alone[0][0], alone[1], alone[0]
    noise_sd_kg = float(np.sqrt(covariance[0, 0]))
    if grasp_sd_m > 0:
        for _ in range(ROUNDS):
            # u = mass x offset is zero, give or take mass x the SD of the offset
            sd = max(abs(mass_kg), noise_sd_kg) * grasp_sd_m
            prior = np.zeros(rows.shape[1])
            prior[1] = 1 / sd
            system = np.vstack([rows * weights[:, None], prior])
            solution, covariance = least_squares(system, np.append(torques * weights, 0.0))
            mass_kg = solution[0]
    _check_agreement(parts, rows, torques, variances, solution, grasp_sd_m, resolution_nm)
    sd_kg = float(np.sqrt(covariance[0, 0]))
    if mass_kg < -BELOW_ZERO_SDS * sd_kg:
        raise SignalError(f"the mass would be {1e3 * mass_kg:.3g} g, below zero: the lever's sign or the zero is wrong")
    joints = list(dict.fromkeys(part.joint for part in parts))
    found = solution[len(solution) - len(joints) :] if drifts else [0.0] * len(joints)
    return Weighing(
        Reading(1e3 * float(mass_kg), 1e3 * sd_kg, "g"),
        1e3 * float(mass_kg),
        1e3 * sd_kg,
        1e3 * noise_sd_kg,
        1e3 * float(np.sqrt(max(sd_kg**2 - noise_sd_kg**2, 0.0))),
        {joint: float(value) for joint, value in zip(joints, found, strict=True)},
    )


def _check_agreement(
    parts: Sequence[CheckedHold],
    rows: NDArray[np.float64],
    torques: NDArray[np.float64],
    variances: NDArray[np.float64],
    solution: NDArray[np.float64],
    grasp_sd_m: float,
    resolution_nm: float,
) -> None:
    """Refuse holds of which no one mass at a grasp that can be is the weight."""
    if grasp_sd_m > 0:
        off_m = float(solution[1]) / (float(solution[0]) or 1.0)
        if abs(off_m) > APART_SDS * grasp_sd_m:
            raise SignalError(
                f"the joints agree only if the grasp is {1e3 * off_m:+.0f} mm off, and its SD is {1e3 * grasp_sd_m:g} "
                "mm: the lever, sign or zero of one is wrong"
            )
    left = torques - (rows if grasp_sd_m > 0 else np.delete(rows, 1, axis=1)) @ solution
    start = 0
    for place, part in enumerate(parts):
        middle, end = start + part.full.size, start + part.full.size + part.empty.size
        apart = float(left[start:middle].mean() - left[middle:end].mean())
        sd = np.sqrt(variances[start] / part.full.size + variances[middle] / part.empty.size + resolution_nm**2)
        if abs(apart) > APART_SDS * sd:
            raise SignalError(
                f"holds[{place}]: {apart:+.3g} Nm are left that no mass explains: the joints do not agree"
            )
        start = end
