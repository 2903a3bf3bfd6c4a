"""Hearing: what a microphone records of a knock on a plate that stands for an object."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.noise import BenchNoise
from palpate.robots.mujoco.sound import Knock, Substance, modes, ring

__all__ = ["BEFORE_S", "DURATION_S", "RATE_HZ", "heard", "recorded"]

RATE_HZ = 44100.0
DURATION_S, BEFORE_S = 1.0, 0.1
SUPPORT_PER_S = 12.0
"""Damping by the table: assumed."""
LEVEL = 0.5
"""Peak of what is recorded, of 1."""


def heard(
    substance: Substance,
    size_mm: tuple[float, float, float],
    wall_mm: float,
    struck: Knock,
    noise: BenchNoise,
    rng: np.random.Generator,
) -> NDArray[np.float64]:
    """Samples between -1 and 1, (n), of a knock after `BEFORE_S` of silence.

    Examples
    --------
    >>> steel = Substance(7850.0, 2.0e11, 0.29, 5.0, 3e-8)
    >>> sound = heard(steel, (120.0, 80.0, 90.0), 1.0, Knock(0.02), BenchNoise(), np.random.default_rng(1))
    >>> sound.shape, float(abs(sound).max().round(1))
    ((44100,), 0.5)
    """
    table = modes(substance, size_mm, wall_mm, SUPPORT_PER_S)
    # no object is the plate that stands for it
    table[:, :2] *= np.exp(noise.sound_spread * rng.standard_normal((len(table), 2)))
    return recorded(ring(table, substance.contact_s, struck, RATE_HZ, DURATION_S - BEFORE_S), noise.sound_floor, rng)


def recorded(sound: NDArray[np.float64], floor: float, rng: np.random.Generator) -> NDArray[np.float64]:
    """As a microphone with automatic gain and 16 bits has it, with silence before, and noise by the sound's peak."""
    samples = np.concatenate([np.zeros(round(BEFORE_S * RATE_HZ)), sound])
    peak = float(np.abs(samples).max())
    loud = LEVEL * samples / peak if peak > 0 else samples
    noisy = loud + LEVEL * floor * rng.standard_normal(len(samples))
    return np.asarray(np.round(np.clip(noisy, -1, 1) * 32767) / 32767)
