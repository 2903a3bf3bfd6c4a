"""The sound of a knock, synthesised from modes.

A struck body rings in modes, each a sinusoid that dies away (van den Doel and Pai 1998, doi 10.1162/105474698565794).
Frequencies are those of a plate of the object's size, thin and supported at its edges: f = h k^2 sqrt(E / (12 rho (1 -
nu^2))) / (2 pi) for thickness h and wave number k. Decays follow Rayleigh damping, d = (alpha + beta (2 pi f)^2) / 2,
whose coefficients belong to the material and not to the shape (Ren, Yeh and Lin 2013, doi 10.1145/2421636.2421637).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["MODES", "Knock", "Substance", "modes", "ring"]

MODES = 48
AUDIBLE_HZ = (60.0, 16000.0)


@dataclass(frozen=True)
class Substance:
    """What an object is made of, as far as sound goes.

    Attributes
    ----------
    density_kgm3, young_pa, poisson
        Of the material.
    alpha_per_s, beta_s
        Rayleigh damping in proportion to mass, and to stiffness.
    contact_s
        How long a fingertip touches it in a knock: soft things are touched longer.
    """

    density_kgm3: float
    young_pa: float
    poisson: float
    alpha_per_s: float
    beta_s: float
    contact_s: float = 5e-4


@dataclass(frozen=True)
class Knock:
    """How an object was struck: impulse [N s], and where, in shares of its length and height."""

    impulse_ns: float
    along: float = 0.31
    up: float = 0.23


def modes(
    substance: Substance, size_mm: tuple[float, float, float], wall_mm: float, support_per_s: float = 0.0
) -> NDArray[np.float64]:
    """Frequencies [Hz] and decays [1/s] of the modes that can be heard, (n, 4) with their two numbers of half waves.

    Parameters
    ----------
    support_per_s
        What it stands on adds this to `alpha_per_s`.
    """
    length, height = max(size_mm[0], size_mm[1]) / 1e3, size_mm[2] / 1e3
    first, second = (grid.ravel() for grid in np.meshgrid(np.arange(1, 13), np.arange(1, 13), indexing="ij"))
    waves = (np.pi * first / length) ** 2 + (np.pi * second / height) ** 2
    bending = np.sqrt(substance.young_pa / (12 * substance.density_kgm3 * (1 - substance.poisson**2)))
    frequency = bending * wall_mm / 1e3 * waves / (2 * np.pi)
    decay = (substance.alpha_per_s + support_per_s + substance.beta_s * (2 * np.pi * frequency) ** 2) / 2
    found = np.stack([frequency, decay, first, second], axis=1)
    heard = (frequency >= AUDIBLE_HZ[0]) & (frequency <= AUDIBLE_HZ[1])
    found = found[heard] if heard.any() else found[:1]
    return found[np.argsort(found[:, 0])][:MODES]


def ring(
    table: NDArray[np.float64], contact_s: float, knock: Knock, rate_hz: float, duration_s: float
) -> NDArray[np.float64]:
    """Sound pressure in no particular unit, (n,), from the moment of the knock.

    Parameters
    ----------
    table
        Modes, as `modes` gives them.
    contact_s
        A touch of half a sine of this length excites what is slower than itself.
    """
    frequency, decay = table[:, 0], table[:, 1]
    shape = np.sin(np.pi * table[:, 2] * knock.along) * np.sin(np.pi * table[:, 3] * knock.up)
    x = 2 * frequency * contact_s
    apart = 1 - x**2
    # the spectrum of half a sine; where x is 1, its limit
    pulse = np.where(np.abs(apart) < 1e-6, np.pi / 4, np.abs(np.cos(np.pi * x / 2) / np.where(apart == 0, 1, apart)))
    time = np.arange(round(duration_s * rate_hz)) / rate_hz
    amplitude = knock.impulse_ns * shape * pulse * (frequency < 0.45 * rate_hz)
    waves = np.exp(-np.outer(time, decay)) * np.sin(2 * np.pi * np.outer(time, frequency))
    return np.asarray(waves @ amplitude)
