"""Measures of beliefs against closed forms, brute force and cases worked out by hand."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, stats

from palpate.errors import EvidenceError
from palpate.experiments.measures import brier, class_wise_ece, covered, cross_entropy_bits, crps
from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.mesh import Mesh
from palpate.inference.message_passing.grid import Grid
from palpate.inference.message_passing.marginals import UnsaidMarginal


def normal(mesh: Mesh, mean: float, sd: float) -> ContinuousMarginal:
    masses = mesh.weights * stats.norm.pdf(mesh.nodes, mean, sd)
    return ContinuousMarginal("x", "m", mesh, masses / masses.sum())


MESHES = [Grid.regular(-40.0, 40.0, 0.05), Mesh(np.linspace(-40.0, 40.0, 61), np.zeros(60, bool))]


@pytest.mark.parametrize("mesh", MESHES)
@pytest.mark.parametrize("truth", [-3.0, 0.4, 9.0])
def test_crps_of_a_normal_belief(mesh: Mesh, truth: float) -> None:
    """The score of a normal belief is sd (z (2 Phi(z) - 1) + 2 phi(z) - 1 / sqrt(pi))."""
    z = (truth - 1.0) / 2.0
    closed = 2.0 * (z * (2 * stats.norm.cdf(z) - 1) + 2 * stats.norm.pdf(z) - 1 / np.sqrt(np.pi))
    assert crps(normal(mesh, 1.0, 2.0), truth) == pytest.approx(closed, abs=0.01)


def test_crps_is_the_integral_that_defines_it() -> None:
    """Two humps: the score is the integral of the squared distance of the distribution function from the step."""
    mesh = Grid.regular(-30.0, 30.0, 0.02)
    density = 0.3 * stats.norm.pdf(mesh.nodes, -4, 1) + 0.7 * stats.norm.pdf(mesh.nodes, 5, 2)
    marginal = ContinuousMarginal("x", "m", mesh, mesh.masses(density))

    def squared(x: float, step: float) -> float:
        return float((0.3 * stats.norm.cdf(x, -4, 1) + 0.7 * stats.norm.cdf(x, 5, 2) - step) ** 2)

    expected = integrate.quad(squared, -30, 1.5, args=(0.0,))[0] + integrate.quad(squared, 1.5, 30, args=(1.0,))[0]
    assert crps(marginal, 1.5) == pytest.approx(expected, abs=1e-3)


def test_crps_where_nothing_is_said() -> None:
    """A belief that says nothing has no score."""
    assert np.isnan(crps(UnsaidMarginal("mass", "g"), 3.0))


@given(st.lists(st.floats(0.01, 1), min_size=2, max_size=6), st.integers(0, 1))
def test_scores_of_states_are_proper(weights: list[float], truth: int) -> None:
    """Certainty of the truth has the lowest scores, zero, and no belief is below them."""
    p = np.array(weights) / sum(weights)
    certain = np.eye(len(p))[truth]
    assert cross_entropy_bits(certain, truth) == 0 <= cross_entropy_bits(p, truth)
    assert brier(certain, truth) == 0 <= brier(p, truth) <= 2


def test_brier_by_hand() -> None:
    """(0.6, 0.3, 0.1) with the second state true: 0.36 + 0.49 + 0.01."""
    assert brier(np.array([0.6, 0.3, 0.1]), 1) == pytest.approx(0.86)


def test_class_wise_ece_by_hand() -> None:
    """Two beliefs of 0.8 of which one is right err by 0.3 for both states."""
    assert class_wise_ece(np.array([[0.8, 0.2], [0.8, 0.2]]), np.array([0, 1])) == pytest.approx(0.3)


def test_class_wise_ece_counts_weights() -> None:
    """A belief of weight three counts as three beliefs."""
    p, truth = np.array([[0.9, 0.1], [0.3, 0.7]]), np.array([0, 0])
    thrice = class_wise_ece(np.repeat(p, [3, 1], axis=0), np.repeat(truth, [3, 1]))
    assert class_wise_ece(p, truth, np.array([3.0, 1.0])) == pytest.approx(thrice)


def test_class_wise_ece_needs_beliefs() -> None:
    """No belief is an error of one sentence."""
    with pytest.raises(EvidenceError, match="no belief was found"):
        class_wise_ece(np.empty((0, 2)), np.empty(0, np.intp))


@given(st.floats(0, 1), st.floats(0.01, 0.99))
def test_coverage_is_that_of_the_central_interval(rank: float, level: float) -> None:
    """A truth is in the interval exactly if its rank is between the interval's two ends."""
    inside = (1 - level) / 2 - 1e-12 <= rank <= (1 + level) / 2 + 1e-12
    outside = rank < (1 - level) / 2 + 1e-12 or rank > (1 + level) / 2 - 1e-12
    found = bool(covered(np.array([rank]), level)[0])
    assert (found and inside) or (not found and outside)
