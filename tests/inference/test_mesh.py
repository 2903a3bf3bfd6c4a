"""Quadrature on meshes against closed forms."""

from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy import stats

from palpate.inference.mesh import Mesh, Pieces, split


def plain(*edges: float) -> Mesh:
    return Mesh(np.array(edges), np.zeros(len(edges) - 1, dtype=bool), edges[0])


def graded(low: float = 0.0, high: float = 10.0, width: float = 1.0) -> Mesh:
    return split(constant(width, low, high), low, high, graded=True)


def constant(scale: float, low: float, high: float) -> Pieces:
    return Pieces(np.array([low]), np.array([high]), lambda x: np.array([scale]))


def integral(mesh: Mesh, f: Any) -> float:
    return float(mesh.weights @ f(mesh.nodes))


edges = st.lists(st.floats(-5, 5), min_size=2, max_size=6, unique=True).map(sorted)


@given(edges, st.lists(st.floats(-1, 1), min_size=1, max_size=12))
@settings(max_examples=60)
def test_polynomials_are_integrated_exactly(places: list[float], coefficients: list[float]) -> None:
    """On plain panels polynomials up to degree 11 are integrated to rounding."""
    assume(min(np.diff(places)) > 1e-3)
    p = np.polynomial.Polynomial(coefficients)
    whole = p.integ()(places[-1]) - p.integ()(places[0])
    size = max(1.0, np.polynomial.Polynomial(np.abs(coefficients)).integ()(5.0))
    assert integral(plain(*places), p) == pytest.approx(whole, abs=1e-13 * size)


@pytest.mark.parametrize("scale", [0.1, 1.0, 30.0])
def test_normal_densities_have_mass_one(scale: float) -> None:
    """A panel of four standard deviations is narrow enough for mass, mean and variance of a normal density."""
    mesh = split(constant(scale, -8 * scale, 8 * scale), -8 * scale, 8 * scale, graded=False)
    density = stats.norm(0.3 * scale, scale).pdf
    assert integral(mesh, density) == pytest.approx(1.0, abs=1e-4)
    assert integral(mesh, lambda x: x * density(x)) == pytest.approx(0.3 * scale, abs=1e-3 * scale)
    halved = mesh.halved()
    assert integral(halved, density) == pytest.approx(1.0, abs=1e-8)
    assert integral(halved, lambda x: x**2 * density(x)) == pytest.approx(1.09 * scale**2, rel=1e-7)


@pytest.mark.parametrize("low", [0.0, 3.0, -2.0])
@pytest.mark.parametrize(("power", "error"), [(-0.5, 2e-4), (-0.3, 1e-5), (0.5, 1e-7), (1.5, 1e-8)])
def test_a_graded_mesh_takes_singular_edges(low: float, power: float, error: float) -> None:
    """Densities such as 1/sqrt(x) at the end of a support are integrated on a graded mesh."""
    mesh = graded(low, low + 10)
    whole = 10 ** (power + 1) / (power + 1)
    assert integral(mesh, lambda x: (x - low) ** power) == pytest.approx(whole, rel=error)
    assert integral(mesh, lambda x: np.log(x - low)) == pytest.approx(10 * np.log(10) - 10, rel=1e-5)
    ungraded = split(constant(1.0, low, low + 10), low, low + 10, graded=False)
    if power < 0:
        assert abs(integral(ungraded, lambda x: (x - low) ** power) - whole) > 10 * error * whole


@given(st.floats(-3, 3), st.floats(0.05, 3), st.booleans())
@settings(max_examples=40)
def test_nodes_ascend_inside_the_edges(low: float, width: float, is_graded: bool) -> None:
    """Nodes are ascending and inside, weights are positive and sum to the length, panels have six nodes."""
    mesh = split(constant(width, low, low + 7), low, low + 7, is_graded)
    assert (np.diff(mesh.edges) > 0).all()
    assert (np.diff(mesh.nodes) > 0).all()
    assert mesh.edges[0] == low < mesh.nodes[0]
    assert mesh.nodes[-1] < mesh.edges[-1] == low + 7
    assert (mesh.weights > 0).all()
    assert mesh.weights.sum() == pytest.approx(7.0, rel=1e-9)
    assert mesh.size == len(mesh.nodes) == 6 * len(mesh.graded)
    assert mesh.log_weights == pytest.approx(np.log(mesh.weights))


def test_panels_are_as_narrow_as_what_is_alive_in_them() -> None:
    """A narrow piece gets narrow panels where it lives and leaves those elsewhere wide; breaks are edges."""
    pieces = Pieces(np.array([0.0, 40.0]), np.array([100.0, 41.0]), lambda x: np.array([10.0, 0.01]))
    mesh = split(pieces, 0.0, 100.0, False, breaks=[62.5])
    widths, middles = np.diff(mesh.edges), (mesh.edges[1:] + mesh.edges[:-1]) / 2
    narrow = (middles > 40) & (middles < 41)
    assert widths[narrow].max() <= 0.0421
    assert widths[~narrow].max() > 10
    assert len(widths) < 60
    assert 62.5 in mesh.edges
    assert mesh.widths_at(np.array([5.0, 40.5, -3.0, 300.0])) == pytest.approx(
        [widths[0], widths[narrow][-1], widths[0], widths[-1]], rel=0.1
    )


def test_gaps_between_pieces_are_one_panel() -> None:
    """Where nothing is alive a single panel reaches to the next piece, or to the end."""
    pieces = Pieces(np.array([0.0, 50.0]), np.array([1.0, 51.0]), lambda x: np.array([1.0, 1.0]))
    mesh = split(pieces, 0.0, 100.0, graded=False)
    assert max(np.diff(mesh.edges)) == pytest.approx(49.0, abs=3.1)
    assert len(mesh.edges) < 8


@pytest.mark.parametrize("mesh", [plain(-1.0, 0.0, 0.5, 2.0), graded(0.0, 2.0, 0.2)], ids=["plain", "graded"])
def test_the_distribution_function_is_the_integral(mesh: Mesh) -> None:
    """Masses of a density give its distribution function at edges and nodes."""
    low = mesh.edges[0]
    at_edges, at_nodes = mesh.cumulative(mesh.weights * (mesh.nodes - low) ** 2)
    # The node density is smooth in the place within a panel, not in x, where the mesh is graded.
    error = 1e-12 if not mesh.graded.any() else 1e-4
    assert at_edges == pytest.approx((mesh.edges - low) ** 3 / 3, abs=error)
    assert at_nodes == pytest.approx((mesh.nodes - low) ** 3 / 3, abs=error)
    stacked = np.stack([mesh.weights, 2 * mesh.weights])
    ends, _ = mesh.cumulative(stacked)
    assert ends[1] == pytest.approx(2 * ends[0])
    assert ends[0] == pytest.approx(mesh.edges - low, abs=1e-4)


def test_edges_and_nodes_are_interleaved() -> None:
    """Points come in order with the distribution function and the density at each."""
    mesh = plain(0.0, 1.0, 3.0)
    density = mesh.nodes / 4.5
    points, below, slopes = mesh.interleaved(*mesh.cumulative(density * mesh.weights), density)
    assert (np.diff(points) > 0).all()
    assert set(mesh.edges) <= set(points)
    assert below == pytest.approx(points**2 / 9)
    assert slopes == pytest.approx(points / 4.5, abs=1e-12)


masses = st.lists(st.floats(0.01, 1), min_size=18, max_size=18).map(np.array)


@given(masses, st.floats(0.003, 0.5))
@settings(max_examples=40)
def test_spreading_over_finer_nodes_conserves_mass(mass: Any, scale: float) -> None:
    """Masses spread over finer nodes sum to the same, in each panel, and averaging is the adjoint of spreading."""
    mesh = plain(0.0, 1.0, 1.5, 4.0)
    finer = mesh.finer(np.full(mesh.size, scale))
    assert finer is not None
    nodes, fine = finer.spread(mass)
    for panel, (low, high) in enumerate(zip(mesh.edges[:-1], mesh.edges[1:], strict=True)):
        inside = (nodes > low) & (nodes < high)
        assert fine[inside].sum() == pytest.approx(mass[6 * panel : 6 * panel + 6].sum(), rel=1e-10)
    averaged = finer.averaged(lambda x: np.column_stack([np.sin(x), np.exp(-x)]), mesh.size)
    expected = [fine @ np.sin(nodes), fine @ np.exp(-nodes)]
    assert mass @ averaged == pytest.approx(expected, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize("mesh", [plain(0.0, 0.7, 1.5, 2.8, 4.0), graded(0.0, 4.0, 0.3)], ids=["plain", "graded"])
def test_finer_nodes_resolve_a_narrow_kernel(mesh: Mesh) -> None:
    """A kernel far narrower than a panel is averaged over a density as if over all values."""
    scale = np.full(mesh.size, 0.01)
    finer = mesh.finer(scale)
    assert finer is not None
    nodes, fine = finer.spread(mesh.weights * stats.norm(1.2, 0.6).pdf(mesh.nodes))
    y = np.array([0.9, 1.2, 2.0])
    found = fine @ stats.norm.pdf(y[None, :], nodes[:, None], 0.01)
    assert found == pytest.approx(stats.norm(1.2, np.hypot(0.6, 0.01)).pdf(y), rel=2e-3)


def test_a_mesh_that_resolves_a_scale_is_not_made_finer() -> None:
    """Where panels are narrow beside the scale there are no finer nodes."""
    assert plain(0.0, 1.0, 2.0).finer(np.full(12, 0.5)) is None


@pytest.mark.parametrize("mesh", [plain(-1.0, 0.0, 0.5, 2.0), graded(1.0, 9.0, 1.0)], ids=["plain", "graded"])
def test_halving_keeps_the_edges(mesh: Mesh) -> None:
    """Halving cuts every panel in two, keeps the old edges and comes closer to the integral."""
    half = mesh.halved()
    assert (half.edges[::2] == mesh.edges).all()
    assert (np.diff(half.edges) > 0).all()
    assert half.graded.sum() == 2 * mesh.graded.sum()
    assert half.weights.sum() == pytest.approx(mesh.weights.sum(), rel=1e-9)
    if mesh.graded.any():

        def singular(x: Any) -> Any:
            return (x - 1.0) ** -0.5

        whole = 2 * np.sqrt(8.0)
        assert abs(integral(half, singular) - whole) < abs(integral(mesh, singular) - whole)


def test_a_stretch_of_panels_is_a_mesh() -> None:
    """The panels from one to another are a mesh with the same nodes and weights."""
    mesh = graded(0.0, 12.0, 1.0)
    part = mesh.between(2, 6)
    assert (part.edges == mesh.edges[2:7]).all()
    assert part.nodes == pytest.approx(mesh.nodes[12:36], rel=1e-14)
    assert part.weights == pytest.approx(mesh.weights[12:36], rel=1e-14)


@pytest.mark.parametrize(
    ("low", "high", "reach"), [(-np.inf, np.inf, (-3.0, 6.0)), (-1.5, 4.4, (-1.5, 4.4)), (0.0, np.inf, (0.0, 6.0))]
)
def test_a_longer_mesh_reaches_further_within_the_support(low: float, high: float, reach: tuple[float, float]) -> None:
    """A longer mesh has the old panels, and others as wide as the last at each end, within the support."""
    mesh = plain(0.0, 1.0, 2.0, 3.0) if low == 0.0 else plain(-1.0, 0.0, 2.0, 3.0)
    longer = mesh.longer(low, high)
    assert set(mesh.edges) <= set(longer.edges)
    assert (np.diff(longer.edges) > 0).all()
    assert low <= longer.edges[0] <= mesh.edges[0]
    assert mesh.edges[-1] < longer.edges[-1] <= high
    assert len(longer.graded) == len(longer.edges) - 1
    # to the end of the support but for less than a panel
    assert longer.edges[0] - max(low, reach[0]) < 1.0
    assert min(high, 4.5) - longer.edges[-1] < 1.0


def test_a_longer_graded_mesh_stays_graded_at_its_end() -> None:
    """A graded mesh that reaches further is graded where it was, and nowhere else."""
    mesh = graded(0.0, 10.0, 1.0)
    longer = mesh.longer(0.0, np.inf)
    assert longer.edges[0] == 0.0
    assert longer.graded.sum() == mesh.graded.sum()
    assert (longer.graded[: len(mesh.graded)] == mesh.graded).all()
    assert longer.weights.sum() == pytest.approx(longer.edges[-1], rel=1e-9)
