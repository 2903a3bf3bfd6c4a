"""What a robot's sensors give: frozen records of raw arrays, with units in their names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["GripperSamples", "HoldSignals", "ImageSignals", "Signals", "SoundSignals", "SqueezeSignals", "WeighSignals"]

Samples = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class HoldSignals:
    """One joint while it holds the object, and at the same pose with the empty, closed gripper.

    Attributes
    ----------
    torque_nm, time_s, empty_torque_nm, empty_time_s
        Samples, (n,) and (k,); all times on one clock.
    lever_m
        Horizontal distance of the nominal grasp from the joint's axis; positive where weight asks for positive torque.
    lever_per_offset
        By how much the lever changes when the object's centre lies further out along the pads by 1.
    angle_rad
        The joint's angle while it holds the object, (n,); None where it was not read.
    """

    joint: str
    torque_nm: Samples
    time_s: Samples
    empty_torque_nm: Samples
    empty_time_s: Samples
    lever_m: float
    lever_per_offset: float
    angle_rad: Samples | None = None


@dataclass(frozen=True, eq=False)
class GripperSamples:
    """What a gripper tells of itself: samples, (n,).

    Attributes
    ----------
    position_counts
        The register of its position: 0 open.
    current_a
        Of its motor; None where it was not read.
    """

    time_s: Samples
    gap_mm: Samples
    force_n: Samples
    position_counts: NDArray[np.int64]
    current_a: Samples | None = None


@dataclass(frozen=True, eq=False)
class WeighSignals:
    """A weighing: a hold for each joint that the weight turns, and the gripper's gap when the hold began and ended.

    The gripper keeps its force, so that a gap of nothing says that it holds nothing.

    Attributes
    ----------
    others
        Holds of the joints that the weight hardly turns: kept with the rest, and not weighed with.
    gripper
        The gripper during the hold.
    """

    holds: tuple[HoldSignals, ...]
    gap_mm: tuple[float, float]
    others: tuple[HoldSignals, ...] = ()
    gripper: GripperSamples | None = None

    @property
    def holds_something(self) -> bool:
        """Whether something was between the fingers from beginning to end."""
        return min(self.gap_mm) > 1.0


@dataclass(frozen=True, eq=False)
class SqueezeSignals:
    """A slow squeeze, from before contact.

    Attributes
    ----------
    time_s, gap_mm, force_n
        Samples, (n,); the gap as the position register tells it, the force on either pad from the motor's current.
    position_counts
        The register itself: 0 open.
    contact_area_mm2, rest_width_mm
        As they are known of the object at rest.
    current_a
        Of the gripper's motor, which the force is told from; None where it was not read.
    """

    time_s: Samples
    gap_mm: Samples
    force_n: Samples
    position_counts: NDArray[np.int64]
    contact_area_mm2: float
    rest_width_mm: float
    current_a: Samples | None = None

    @property
    def gripper(self) -> GripperSamples:
        """The samples alone."""
        return GripperSamples(self.time_s, self.gap_mm, self.force_n, self.position_counts, self.current_a)


@dataclass(frozen=True, eq=False)
class SoundSignals:
    """A knock as a microphone hears it.

    Attributes
    ----------
    samples
        Between -1 and 1, (n,).
    impulse_ns
        Of the fingertip [N s]; None where it is not known.
    """

    samples: Samples
    rate_hz: float
    impulse_ns: float | None = None


@dataclass(frozen=True, eq=False)
class ImageSignals:
    """What the camera sees: (height, width, 3), red, green and blue."""

    image: NDArray[np.uint8]


Signals = WeighSignals | SqueezeSignals | SoundSignals | ImageSignals
