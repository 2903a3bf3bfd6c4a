from dataclasses import replace

import pytest

from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.noise import BenchNoise
from palpate.robots.mujoco.objects import Look, Part
from palpate.robots.mujoco.scene import Scene


def test_a_body_has_the_object_s_mass(block) -> None:
    """Core and plates together weigh what the object weighs."""
    model = Scene(block(mass_g=123.0)).model
    assert sum(model.body(name).mass[0] for name in ("object", "near", "far")) == pytest.approx(0.123)


@pytest.mark.parametrize(
    ("figures", "told"),
    [
        ({"mass_g": 0.0}, "mass_g 0.0 was found, expected more than 0"),
        ({"elasticity_kpa": -5.0}, r"elasticity_kpa -5\.0 was found"),
        ({"grip_width_mm": 90.0}, "grip_width_mm 90 was found, expected at most 83: the gripper opens to 85 mm"),
    ],
)
def test_figures_that_cannot_be_are_named(block, figures, told: str) -> None:
    """An object that the bench cannot hold or have is refused with the figure."""
    with pytest.raises(BenchError, match=told):
        replace(block(), **figures)


@pytest.mark.parametrize(
    ("part", "told"),
    [
        (Part("cone", Look()), "kind 'cone' was found: choose from 'box', 'ellipsoid'"),
        (Part("box", Look()), "of kind 'box' lacks 'size_mm'"),
        (Part("box", Look(pattern="plaid"), {"size_mm": (1, 1, 1)}), "pattern 'plaid' was found"),
    ],
)
def test_parts_that_cannot_be_made_are_named(block, part: Part, told: str) -> None:
    """An unknown kind or pattern, or a missing figure, is one sentence."""
    with pytest.raises(BenchError, match=told):
        Scene(replace(block(), parts=(part,)))


def test_noise_that_cannot_be_is_refused() -> None:
    """Noise below zero and probabilities above one are errors that name the figure."""
    with pytest.raises(BenchError, match=r"force_sd_n -1 was found, expected 0 to 1000"):
        BenchNoise(force_sd_n=-1)
    with pytest.raises(BenchError, match=r"torque_drift_nm_per_s 1e\+300 was found, expected 0 to 1000"):
        BenchNoise(torque_drift_nm_per_s=1e300)
    with pytest.raises(BenchError, match=r"light_sd 50 was found, expected 0 to 1"):
        BenchNoise(light_sd=50)
    with pytest.raises(BenchError, match=r"slip_probability 2 was found, expected 0 to 1"):
        BenchNoise(slip_probability=2)
