import sys
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sklearn.exceptions import ConvergenceWarning
from sklearn.mixture import GaussianMixture

from palpate.errors import PalpateError
from palpate.inference.message_passing.mixture_fit import Mixture, fit_weights, weights_of
from palpate.inference.message_passing.settings import Settings

MEANS, SDS = np.array([10.0, 40.0, 55.0]), np.array([5.0, 8.0, 4.0])
MIXTURE = Mixture.on_own_grid(MEANS, SDS)


def by_scikit_learn(samples: np.ndarray, means: np.ndarray, iterations: int, seed: int) -> tuple[np.ndarray, bool]:
    model = GaussianMixture(
        len(means), means_init=means[:, None], tol=1e-6, max_iter=iterations,
        random_state=int(np.random.default_rng(seed).integers(2**31)),
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        model.fit(samples[:, None])
    return model.weights_, model.converged_


@given(st.integers(0, 1000), st.integers(2, 200), st.sampled_from([3, 30, 400]), st.booleans())
@settings(max_examples=25, deadline=None)
def test_the_fit_is_that_of_scikit_learn(seed: int, iterations: int, size: int, on_grid: bool) -> None:
    """Weights and convergence are those of GaussianMixture with the same means, seed and iterations."""
    rng = np.random.default_rng(seed)
    samples = rng.normal(*rng.choice(np.stack([MEANS, SDS], axis=1), size).T)
    samples = samples.round() if on_grid else samples
    weights, converged = fit_weights(samples, MEANS, iterations, 1e-6, np.random.default_rng(seed))
    expected, expected_converged = by_scikit_learn(samples, MEANS, iterations, seed)
    assert weights == pytest.approx(expected, abs=1e-8)
    assert converged == expected_converged
    assert weights.sum() == pytest.approx(1)


def test_few_distinct_samples_are_no_trouble() -> None:
    """Fewer distinct samples than components fit without a warning, as GaussianMixture fits them."""
    samples = np.repeat([10.0, 11.0], 50)
    weights, _ = fit_weights(samples, MEANS, 100, 1e-6, np.random.default_rng(3))
    assert weights == pytest.approx(by_scikit_learn(samples, MEANS, 100, 3)[0], abs=1e-12)


def test_weights_of_components_far_apart_are_found() -> None:
    """Of a mixture whose components do not overlap the fit finds the weights to sampling error."""
    apart = Mixture.on_own_grid(np.array([0.0, 100.0]), np.array([2.0, 2.0]))
    weights = weights_of(apart, apart.density(np.array([0.3, 0.7])), Settings.as_released(), np.random.default_rng(0))
    assert weights == pytest.approx([0.3, 0.7], abs=0.02)


@pytest.mark.parametrize(("refits", "draws"), [(0, 500), (2, 1500)])
def test_a_fit_that_does_not_converge_is_made_again(refits: int, draws: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each refit adds as many samples and one more times the iterations; the last one counts."""
    seen = []

    def never(samples, means, iterations, tolerance, rng):
        seen.append((len(samples), iterations))
        return np.full(3, 1 / 3), False

    monkeypatch.setattr("palpate.inference.message_passing.mixture_fit.fit_weights", never)
    asked = Settings(quotient_counts=False, emulation_times_belief=True, fit_samples=500, refits=refits)
    weights_of(MIXTURE, MIXTURE.density(np.full(3, 1 / 3)), asked, np.random.default_rng(0))
    assert seen == [(500 * k, 100 * k) for k in range(1, refits + 2)]
    assert seen[-1][0] == draws


def test_the_grid_reaches_five_sds_beyond_the_outer_means() -> None:
    """From the lowest mean - 5 of its SD to the highest mean + 5 of its SD, in steps of a tenth of the smallest SD."""
    nodes = MIXTURE.grid.nodes
    assert (nodes[0], nodes[-1]) == pytest.approx((10 - 25, 55 + 20))
    assert np.diff(nodes) == pytest.approx(0.4)


def test_a_missing_scikit_learn_is_one_clear_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where scikit-learn is not installed the error says what to install."""
    monkeypatch.setitem(sys.modules, "sklearn.cluster", None)
    with pytest.raises(PalpateError, match=r'scikit-learn, which is not installed: pip install "palpate\[reproduce\]"'):
        fit_weights(np.arange(9.0), MEANS, 10, 1e-6, np.random.default_rng(0))
