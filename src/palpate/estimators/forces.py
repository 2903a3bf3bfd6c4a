"""What a force does that is none of the object's: it slips, is cut off, or its zero drifts."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.correlated import covariance_of_fit
from palpate.estimators.hinge import scatter
from palpate.estimators.signals import RUN, SignalError

__all__ = ["check_slip", "drift_before", "uncut"]

Floats: TypeAlias = NDArray[np.float64]

DROP = 0.25
"""The force falls by this share of what it had grown by where the object slips."""
SLIP_SAMPLES, SLIP_SDS = 5, 6.0
"""A slip is a fall between so many samples and as many after them, by so many SDs of their means' difference."""
QUARTILE_SDS = 0.3186
"""A quarter of normal errors are smaller than so many SDs."""
LEAST_IDLE, MARGIN = 30, 0.3
"""A drift is read from so many samples, before contact by this share of the way to it: soft things begin softly."""
KINKS = 50
DRIFT_SDS, NOTHING = 3.0, 1e-9


def check_slip(gap: Floats, force: Floats) -> None:
    """The force must not fall by much while the jaws close.

    It is looked for before any line is fitted: after an early slip most samples are without contact, and no line fits.
    A force that wanders falls as well: by how much, its smaller falls tell.

    Raises
    ------
    SignalError
        Where it falls, and by how much.
    """
    means = np.lib.stride_tricks.sliding_window_view(force, SLIP_SAMPLES).mean(axis=1)
    before, after = means[:-SLIP_SAMPLES], means[SLIP_SAMPLES:]
    if before.size == 0:
        return
    falls = before - after
    worst = int(np.argmax(falls))
    fall, height = float(falls[worst]), float(before[worst] - means[: worst + 1].min())
    # growth hides falls, and the slip's own are few: the lower quarter of them is of the noise
    wander = float(np.quantile(falls[falls > 0], 0.25)) / QUARTILE_SDS if fall > 0 else 0.0
    sure = SLIP_SDS * max(scatter(force) * (2 / SLIP_SAMPLES) ** 0.5, wander)
    if height > sure and fall > max(DROP * height, sure):
        raise SignalError(
            f"slip: the force falls by {fall:.3g} N from {before[worst]:.3g} N at {gap[worst + SLIP_SAMPLES]:.3g} mm"
        )


def uncut(force: Floats) -> int:
    """How many samples come before those, at the end, at which the force is cut off: all of them where it is not.

    Examples
    --------
    >>> uncut(np.array([0.0, 1.0, 2.0, 3.0, 3.0, 3.0]))
    3
    >>> uncut(np.array([0.0, 1.0, 2.0, 3.0, 3.5, 4.0]))
    6
    """
    return int(np.argmax(force)) if np.all(force[-RUN:] == force.max()) else force.size


def drift_before(gap: Floats, force: Floats) -> tuple[float, float]:
    """By how much the force drifts per sample before contact [N], and its SD; zeros where nothing sure is seen."""
    contact = _kink(gap, force)
    count = int(np.argmin(gap > contact + MARGIN * (gap[0] - contact)))
    if count < LEAST_IDLE:
        return 0.0, 0.0
    order = np.arange(count) - (count - 1) / 2
    columns = np.column_stack([np.ones(count), order])
    drift = float(order @ force[:count] / (order @ order))
    left = force[:count] - force[:count].mean() - drift * order
    sd = float(np.sqrt(covariance_of_fit(columns, left, np.ones(count), np.zeros(count))[1, 1]))
    sure = abs(drift) > DRIFT_SDS * sd and abs(drift) * count > NOTHING * np.ptp(force)
    return (drift, sd) if sure else (0.0, 0.0)


def _kink(gap: Floats, force: Floats) -> float:
    """Where a line begins on top of a drift: a fit without one would begin with the drift."""
    best, least = float(gap.min()), np.inf
    order = np.arange(gap.size) / gap.size
    for contact in np.linspace(gap.min(), gap[0], KINKS + 2)[1:-1]:
        columns = np.column_stack([np.ones(gap.size), order, np.maximum(0.0, contact - gap)])
        found, *_ = np.linalg.lstsq(columns, force, rcond=None)
        squares = float(np.sum((force - columns @ found) ** 2))
        if squares < least:
            best, least = float(contact), squares
    return best
