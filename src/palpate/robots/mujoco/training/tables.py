"""Modal tables: what rings, drawn at random as plates of every material, or read from where others have measured them.

A table is one thing that rings. Sounds of the same table are copies of each other but for where it was struck and for
noise, so that only tables that were left out tell how a classifier fares on something new.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.util import find_spec
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from palpate.errors import PalpateError
from palpate.robots.mujoco.hearing import BEFORE_S, DURATION_S, RATE_HZ, heard, recorded
from palpate.robots.mujoco.noise import BenchNoise
from palpate.robots.mujoco.sound import Knock, Substance

__all__ = ["WALLS_MM", "Measured", "Plate", "Table", "draw_plates", "read_measured"]

WALLS_MM: Mapping[str, tuple[float, float]] = {
    "ceramic": (3.0, 10.0),
    "glass": (1.2, 4.0),
    "metal": (0.5, 3.0),
    "soft-plastic": (1.0, 5.0),
    "hard-plastic": (1.0, 4.0),
    "wood": (3.0, 20.0),
    "paper": (0.4, 3.0),
    "foam": (10.0, 40.0),
}
"""How thick things of a material are: assumed."""
SIZE_MM = (40.0, 220.0)
YOUNG_SD, DENSITY_SD, DAMPING_SD, CONTACT_SD = 0.2, 0.1, 0.4, 0.3
"""Relative SD between things of one material: assumed."""
IMPULSE_NS = 0.02
STRUCK = (0.15, 0.45)
MEASURED = {
    "ceramic": "ceramic",
    "glass": "glass",
    "metal": "metal",
    "plastic_hard": "hard-plastic",
    "plastc_hard": "hard-plastic",
    "wood_hard": "wood",
    "wood_medium": "wood",
    "wood_soft": "wood",
    "cardboard": "paper",
    "paper": "paper",
    "plastic_soft_foam": "foam",
}
"""Names in the package tdw, one misspelt there, to the network's materials; it has nothing of soft plastic alone."""
MEASURED_MODES = 10
"""So many modes of a table are used there; what follows them is partly of other materials."""
POWER_SD_DB = 6.0
"""SD of a mode's level from one spot that is struck to the next: assumed."""


class Table(Protocol):
    """Something that rings, of a known material."""

    @property
    def label(self) -> str:
        """Its material."""

    def sound(self, noise: BenchNoise, rng: np.random.Generator) -> NDArray[np.float64]:
        """Record a knock somewhere on it, (n), at `palpate.robots.mujoco.hearing.RATE_HZ`."""


@dataclass(frozen=True)
class Plate:
    """A plate as the bench makes objects ring."""

    label: str
    substance: Substance
    size_mm: tuple[float, float, float]
    wall_mm: float

    def sound(self, noise: BenchNoise, rng: np.random.Generator) -> NDArray[np.float64]:
        """Record a knock somewhere on it."""
        struck = Knock(IMPULSE_NS, *rng.uniform(*STRUCK, 2))
        return heard(self.substance, self.size_mm, self.wall_mm, struck, noise, rng)


@dataclass(frozen=True)
class Measured:
    """Frequencies [Hz], levels [dB] and times of a fall by 60 dB [s] of the modes of something real."""

    label: str
    frequency_hz: tuple[float, ...]
    level_db: tuple[float, ...]
    decay_s: tuple[float, ...]

    def sound(self, noise: BenchNoise, rng: np.random.Generator) -> NDArray[np.float64]:
        """Record a knock on it."""
        modes = len(self.frequency_hz)
        frequency, decay = (
            np.array(values) * np.exp(noise.sound_spread * rng.standard_normal(modes))
            for values in (self.frequency_hz, self.decay_s)
        )
        amplitude = 10 ** ((np.array(self.level_db) + POWER_SD_DB * rng.standard_normal(modes)) / 20)
        time = np.arange(round((DURATION_S - BEFORE_S) * RATE_HZ)) / RATE_HZ
        waves = np.sin(2 * np.pi * np.outer(time, frequency)) * 10 ** (-3 * np.outer(time, 1 / decay))
        return recorded(waves @ amplitude, noise.sound_floor, rng)


def draw_plates(substances: Mapping[str, Substance], each: int, rng: np.random.Generator) -> list[Plate]:
    """Draw so many plates of each material; sizes, walls and the figures of the material differ from one to the next.

    Parameters
    ----------
    substances
        Materials of `WALLS_MM` and their figures.

    Examples
    --------
    >>> steel = Substance(7850.0, 2.0e11, 0.29, 5.0, 3e-8)
    >>> plates = draw_plates({"metal": steel}, 3, np.random.default_rng(1))
    >>> [plate.label for plate in plates], len({plate.wall_mm for plate in plates})
    (['metal', 'metal', 'metal'], 3)
    """
    return [_plate(label, substance, rng) for label, substance in substances.items() for _ in range(each)]


def _plate(label: str, substance: Substance, rng: np.random.Generator) -> Plate:
    spread = np.exp(rng.standard_normal(5) * [YOUNG_SD, DENSITY_SD, DAMPING_SD, DAMPING_SD, CONTACT_SD])
    own = replace(
        substance,
        young_pa=substance.young_pa * spread[0],
        density_kgm3=substance.density_kgm3 * spread[1],
        alpha_per_s=substance.alpha_per_s * spread[2],
        beta_s=substance.beta_s * spread[3],
        contact_s=substance.contact_s * spread[4],
    )
    length, height = rng.uniform(*SIZE_MM, 2)
    wall_mm = float(np.exp(rng.uniform(*np.log(WALLS_MM[label]))))
    return Plate(label, own, (float(length), float(length), float(height)), wall_mm)


def read_measured(folder: str | Path | None = None) -> list[Measured]:
    """Read the tables of the package tdw that differ from each other: sizes share tables there.

    Parameters
    ----------
    folder
        Where they are; in the installed package unless given.

    Raises
    ------
    PalpateError
        The package is not installed, or holds no tables that can be read.
    """
    place = Path(folder) if folder is not None else _installed()
    found: dict[Measured, None] = {}
    for path in sorted(place.glob("*_mm.json")):
        kind = path.stem.lower().rsplit("_", 2)[0]
        if kind in MEASURED:
            found[_measured(MEASURED[kind], path)] = None
    if not found:
        raise PalpateError(f"{place}: no modal tables were found, expected those of the package tdw 1.13")
    return list(found)


def _installed() -> Path:
    spec = find_spec("tdw")
    places: Sequence[str] = spec.submodule_search_locations or () if spec is not None else ()
    if not places:
        raise PalpateError("measured modal tables are those of the package tdw, which is not installed")
    return Path(places[0]) / "add_ons" / "py_impact" / "material_data"


def _measured(label: str, path: Path) -> Measured:
    try:
        plain = json.loads(path.read_text(encoding="utf-8"))
        columns = [tuple(float(value) for value in plain[key][:MEASURED_MODES]) for key in ("cf", "op", "rt")]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise PalpateError(f"{path}: cannot be read ({error!r}), expected a modal table of tdw") from None
    return Measured(label, *columns)
