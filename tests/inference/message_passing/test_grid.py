import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.message_passing.grid import Grid
from palpate.inference.message_passing.marginals import UnsaidMarginal

GRID = Grid.regular(-80.0, 120.0, 0.5)


def normal(mean: float, sd: float, grid: Grid = GRID) -> np.ndarray:
    return np.asarray(np.exp(-0.5 * ((grid.nodes - mean) / sd) ** 2) / (sd * np.sqrt(2 * np.pi)))


@given(st.floats(-20, 60), st.floats(3, 10))
def test_a_normal_on_the_grid_has_its_closed_forms(mean: float, sd: float) -> None:
    """Mean, SD, entropy and quantiles of a marginal on a grid are those of the normal it holds."""
    marginal = ContinuousMarginal("x", "cm", GRID, GRID.masses(normal(mean, sd)))
    assert marginal.mean == pytest.approx(mean, abs=1e-6)
    assert marginal.sd == pytest.approx(sd, rel=1e-6)
    assert marginal.entropy_bits == pytest.approx(0.5 * np.log2(2 * np.pi * math.e * sd**2), abs=1e-6)
    # six SDs from its end the grid misses 4e-9 bits
    assert GRID.entropy_bits(normal(mean, sd)) == pytest.approx(marginal.entropy_bits, abs=1e-8)
    assert marginal.quantile(0.95) == pytest.approx(mean + 1.6448536 * sd, abs=2e-3 * sd)
    assert marginal.cdf(mean) == pytest.approx(0.5, abs=1e-3)
    x, density = marginal.curve
    assert np.trapezoid(density, x) == pytest.approx(1, abs=1e-9)


@given(st.floats(-20, 60), st.floats(2, 6), st.floats(2, 8))
def test_blurring_adds_variances(mean: float, sd: float, noise: float) -> None:
    """A normal blurred by a normal has the sum of the variances, and stays where it is when the middle is whole."""
    blurred = GRID.blurred(normal(mean, sd), noise)
    assert blurred == pytest.approx(normal(mean, float(np.hypot(sd, noise))), abs=1e-6)


def test_the_kernel_stands_at_the_whole_number_below_the_middle() -> None:
    """Where the middle of the axis is no whole number, blurring shifts by what is cut off, as in the program."""
    grid = Grid.regular(-80.5, 120.0, 0.5)  # its middle is 19.75, which is no node: the convolution starts at 19.5
    marginal = ContinuousMarginal("x", "cm", grid, grid.masses(grid.blurred(normal(10, 3, grid), 4)))
    assert marginal.mean == pytest.approx(10 + 19 - 19.5, abs=1e-6)


def test_a_density_that_is_not_scaled_keeps_its_own_entropy() -> None:
    """The entropy of f is the integral of -f log2 f for f as it is, also where f integrates to 0.98."""
    whole = GRID.entropy_bits(normal(0, 5))
    assert GRID.entropy_bits(0.98 * normal(0, 5)) == pytest.approx(0.98 * (whole - np.log2(0.98)), abs=1e-9)


def test_draws_are_nodes_in_proportion() -> None:
    """Draws are nodes of the grid, as often as the density says."""
    drawn = GRID.draw(normal(10, 5), 200_000, np.random.default_rng(1))
    assert np.isin(drawn, GRID.nodes).all()
    assert drawn.mean() == pytest.approx(10, abs=0.05)
    assert drawn.std() == pytest.approx(5, abs=0.05)


def test_where_nothing_is_said_no_target_is_reached() -> None:
    """A marginal of which nothing is said has no figures, no curve, and an SD above every target."""
    marginal = UnsaidMarginal("mass", "g")
    assert np.isnan([marginal.mean, marginal.entropy_bits, marginal.quantile(0.5), marginal.cdf(3.0)]).all()
    assert marginal.sd == np.inf
    assert [part.size for part in marginal.curve] == [0, 0]
