"""The equations that holds give for a mass, the offset of the grasp, zeros and drifts, and their solution."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.holds import CheckedHold
from palpate.estimators.signals import EstimatorError, correlation_factor

__all__ = ["equations", "least_squares"]

GRAVITY_M_S2 = 9.80665


def equations(
    parts: Sequence[CheckedHold], drifts: bool
) -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Rows (n, p), torques (n) and their variances (n): mass, mass x offset, a zero per part, a drift per joint."""
    joints = list(dict.fromkeys(part.joint for part in parts))
    count = 2 + len(parts) + (len(joints) if drifts else 0)
    start = min(min(part.full_s.min(), part.empty_s.min()) for part in parts)
    rows, torques, variances = [], [], []
    for place, part in enumerate(parts):
        for held, values, stamps in ((1.0, part.full, part.full_s), (0.0, part.empty, part.empty_s)):
            row = np.zeros((values.size, count))
            row[:, 0] = held * GRAVITY_M_S2 * part.lever_m
            row[:, 1] = held * GRAVITY_M_S2 * part.per_offset
            row[:, 2 + place] = 1.0
            if drifts:
                row[:, 2 + len(parts) + joints.index(part.joint)] = stamps - start
            rows.append(row)
            torques.append(values)
            variances.append(np.full(values.size, _variance(values, stamps, drifts)))
    return np.vstack(rows), np.concatenate(torques), np.concatenate(variances)


def _variance(values: NDArray[np.float64], stamps: NDArray[np.float64], drifts: bool) -> float:
    """Variance of a sample about its level, as large as if samples that resemble their neighbours were independent."""
    residuals, fitted = values - values.mean(), 1
    if drifts and np.ptp(stamps) > 0:
        residuals, fitted = values - np.polynomial.Polynomial.fit(stamps, values, 1)(stamps), 2
    power = float(residuals @ residuals)
    # a resting sensor is no surer than the last digit of a number
    least = (1e-9 * max(1.0, float(np.abs(values).max()))) ** 2
    return max(power / (values.size - fitted), least) * correlation_factor(residuals, fitted=fitted)


def least_squares(
    rows: NDArray[np.float64], values: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """The solution, (p), and its covariance, (p, p); EstimatorError where the poses do not determine it."""
    # columns of one length: masses and torques differ by orders of magnitude
    scale = np.linalg.norm(rows, axis=0)
    if not np.all(scale > 0) or np.linalg.matrix_rank(rows / scale) < rows.shape[1]:
        raise EstimatorError("holds: poses and times do not tell mass, zero and drift apart, expected them to differ")
    inverse = np.linalg.inv((rows / scale).T @ (rows / scale))
    solution = inverse @ ((rows / scale).T @ values)
    return solution / scale, inverse / np.outer(scale, scale)
