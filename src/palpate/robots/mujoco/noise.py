"""How real the bench's sensors and grasps are."""

from __future__ import annotations

from dataclasses import dataclass, fields

from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.gripper import POSITION_STEP_MM

__all__ = ["QUIET", "BenchNoise"]

RELATIVE = ("force_gain_sd", "sound_spread", "sound_floor", "light_sd")
MOST = 1000.0


@dataclass(frozen=True)
class BenchNoise:
    """Noise, quantisation, grasp offsets and failures; all are drawn from the robot's generator.

    Attributes
    ----------
    torque_sd_nm
        Of each sample of each joint. 50 samples of the holding joint are then masses with an SD of 5.3 g, as in the
        recorded session of the paper.
    torque_drift_nm_per_s
        SD of a joint's drift, drawn for each weighing: assumed.
    torque_offset_nm
        SD of a joint's constant error, which the empty gripper's torque takes out: assumed.
    force_sd_n, force_gain_sd
        Of the squeezing force: each sample's noise, and the relative error of current as a measure of force: assumed.
    position_step_mm
        Step of the gripper's position; 0 is none.
    width_sd_mm
        Of the rest width as the bench knows it: assumed.
    grasp_offset_mm
        Grasps are off along the pads by up to this, either way, evenly spread.
    centring_sd_mm
        SD by which the gripper stands to one side of the object's middle: assumed.
    sound_spread, sound_floor
        Relative SD of modes' frequencies and decays; noise of the microphone by the sound's peak: assumed.
    pixel_sd
        Noise of the camera, of 255: assumed.
    place_sd_mm, turn_sd_deg, light_sd
        How differently objects are put down before an image, and relative SD of the lamps: assumed.
    miss_probability, drop_probability, slip_probability
        That the fingers close above the object, that it falls as it is lifted, and that it slips while it is held or
        squeezed: assumed.
    """

    torque_sd_nm: float = 0.0159
    torque_drift_nm_per_s: float = 2e-4
    torque_offset_nm: float = 0.05
    force_sd_n: float = 0.15
    force_gain_sd: float = 0.0
    position_step_mm: float = POSITION_STEP_MM
    width_sd_mm: float = 0.5
    grasp_offset_mm: float = 10.0
    centring_sd_mm: float = 1.0
    sound_spread: float = 0.05
    sound_floor: float = 0.003
    pixel_sd: float = 1.5
    place_sd_mm: float = 8.0
    turn_sd_deg: float = 10.0
    light_sd: float = 0.05
    miss_probability: float = 0.01
    drop_probability: float = 0.01
    slip_probability: float = 0.01

    def __post_init__(self) -> None:
        for entry in fields(self):
            value, most = getattr(self, entry.name), _most(entry.name)
            if not 0 <= value <= most:
                raise BenchError(f"noise: {entry.name} {value!r} was found, expected 0 to {most:g}")


def _most(name: str) -> float:
    """A share is at most one; beyond the other bound nothing is left of any signal."""
    return 1.0 if name.endswith("_probability") or name in RELATIVE else MOST


QUIET = BenchNoise(**{entry.name: 0.0 for entry in fields(BenchNoise)})
"""Perfect sensors and grasps."""
