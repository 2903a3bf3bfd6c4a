import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from palpate.inference.message_passing.graph import Graph, Quotient
from palpate.inference.message_passing.grid import Grid
from palpate.inference.message_passing.measuring import divided, seen, softened
from palpate.inference.message_passing.mixture_fit import Mixture
from palpate.inference.message_passing.settings import Settings
from palpate.network.formula import Formula
from palpate.outcomes import Above, Below, Reading

GRID = Grid.regular(0.0, 100.0, 0.5)
MASS = Formula.parse("density * volume / 1000")


@given(arrays(float, st.integers(2, 9), elements=st.floats(0.01, 1)), st.floats(0, 0.5))
def test_softening_keeps_the_sum_and_the_order(vector: np.ndarray, error: float) -> None:
    """The softened vector sums to one, a uniform one stays uniform, and no two states change places."""
    found = softened(vector, error)
    assert found.sum() == pytest.approx(1)
    assert (np.diff(found[np.argsort(vector, kind="stable")]) >= -1e-12).all()
    assert softened(np.full(len(vector), 0.3), error) == pytest.approx(1 / len(vector))


def test_a_reading_multiplies_by_a_normal() -> None:
    """A normal density of SD 6 about 40 and a reading of 50 with SD 8 give the precision-weighted mean and SD."""
    density = np.exp(-0.5 * ((GRID.nodes - 40) / 6) ** 2)
    masses = GRID.masses(seen(GRID, density, Reading(50.0), 8.0))
    mean = masses @ GRID.nodes
    assert mean == pytest.approx((40 / 36 + 50 / 64) / (1 / 36 + 1 / 64), abs=1e-6)
    assert masses @ (GRID.nodes - mean) ** 2 == pytest.approx(1 / (1 / 36 + 1 / 64), abs=1e-6)


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 10))
def test_no_reading_vanishes(value: float, sd: float) -> None:
    """However far and sharp, a reading leaves a density above zero near itself."""
    product = seen(GRID, np.where(GRID.nodes > 20, 1.0, 0.0), Reading(value), sd)
    assert np.isfinite(product).all()
    nearest = int(np.abs(GRID.nodes - max(value, 20.5)).argmin())
    assert product[nearest] > 0


def test_bounds_are_half_open() -> None:
    """Above and below cut at the bound, which itself is left out; beyond the grid nothing is left."""
    ones = np.ones(GRID.size)
    assert GRID.nodes[seen(GRID, ones, Above(95.0), 10.0) > 0][0] == 95.5
    assert GRID.nodes[seen(GRID, ones, Below(5.0), 10.0) > 0][-1] == 4.5
    assert not seen(GRID, ones, Above(100.0), 10.0).any()


def quotient_graph(volume_mean: float) -> Graph:
    mixtures = {
        "density": Mixture.on_own_grid(np.array([1000.0, 3000.0]), np.array([50.0, 90.0])),
        "volume": Mixture.on_own_grid(np.array([volume_mean]), np.array([1.0])),
    }
    return Graph({}, {}, {}, mixtures, {"mass": Quotient("density", "kg/m^3", 223.0, 11_000.0)})


def test_samples_of_a_quotient_are_mass_over_volume() -> None:
    """100 g over 50 cm^3 is 2000 kg/m^3, with the spread of both; the formula says so, not the code."""
    graph = quotient_graph(50.0)
    samples = divided(
        graph, graph.prior, "mass", MASS, Reading(100.0, 3.0), Settings.repaired(), np.random.default_rng(0)
    )
    assert len(samples) == 10_000
    assert samples.mean() == pytest.approx(2000, rel=0.003)
    assert samples.std() == pytest.approx(2000 * np.hypot(0.03, 0.02), rel=0.05)


@pytest.mark.parametrize(("volume_mean", "least", "most"), [(5.0, 1, 9999), (1.0, 0, 10), (-20.0, 0, 0)])
def test_samples_beyond_the_limit_and_volumes_below_zero_are_dropped(volume_mean: float, least: int, most: int) -> None:
    """50 g over 5 cm^3 straddles the limit of 11 000 kg/m^3, over 1 cm^3 exceeds it; below zero there is nothing."""
    graph = quotient_graph(volume_mean)
    samples = divided(
        graph, graph.prior, "mass", MASS, Reading(50.0, 3.0), Settings.repaired(), np.random.default_rng(0)
    )
    assert least <= len(samples) <= most
    assert (samples <= 11_000).all()
