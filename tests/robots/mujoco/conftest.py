"""The bench's tests need MuJoCo; those that draw also need a way to draw without a screen."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from importlib.util import find_spec
from typing import Any

import numpy as np
import pytest

if find_spec("mujoco") is None:
    collect_ignore_glob = ["test_*.py"]
else:
    from palpate.robots.mujoco.bench import Bench
    from palpate.robots.mujoco.noise import QUIET, BenchNoise
    from palpate.robots.mujoco.objects import BenchObject, Look, Part
    from palpate.robots.mujoco.sound import Substance

    WOOD = Substance(750.0, 1.1e10, 0.25, 60.0, 2e-6)

    @pytest.fixture(scope="session")
    def block() -> Callable[..., BenchObject]:
        """Make a plain block: mass [g], elasticity [kPa], size [mm]."""

        def make(mass_g: float = 200.0, elasticity_kpa: float = 50.0, size: Any = (70.0, 60.0, 70.0)) -> BenchObject:
            part = Part("box", Look(light=(200, 30, 30)), {"size_mm": size})
            return BenchObject(
                "block", mass_g, elasticity_kpa, WOOD, size, size[2] / 2, size[1], (size[0], size[2]), parts=(part,)
            )

        return make

    @pytest.fixture
    def bench(block: Any) -> Callable[..., Bench]:
        """Make a bench with a block; without noise unless some is given."""

        def make(noise: BenchNoise = QUIET, seed: int = 0, **figures: Any) -> Bench:
            return Bench(block(**figures), noise, np.random.default_rng(seed))

        return make

    @pytest.fixture(scope="session")
    def surely() -> Callable[[str], BenchNoise]:
        """Perfect sensors, and a mishap each time."""
        return lambda mishap: replace(QUIET, **{f"{mishap}_probability": 1.0})
