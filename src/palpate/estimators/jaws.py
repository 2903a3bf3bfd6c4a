"""What is known of a gripper before it squeezes: its force, and how it touches."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.estimators.signals import EstimatorError

__all__ = ["ForceCalibration", "Jaws"]


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
