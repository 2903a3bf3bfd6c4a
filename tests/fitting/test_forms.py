"""Location and spread, and what they are in the file of a network."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.fitting.forms import Form, GammaForm, LogNormalForm, NormalForm, StudentForm, form_of
from palpate.network.families import Gamma, LogNormal, Normal, StudentT, Uniform

FORMS: list[Form] = [NormalForm(-np.inf, np.inf), NormalForm(0.0, 50.0), LogNormalForm(), GammaForm(), StudentForm(5.0)]


@given(st.sampled_from(FORMS), st.floats(-2, 3), st.floats(0.1, 2))
def test_parameters_are_those_of_the_density(form: Form, location: float, spread: float) -> None:
    """What is written into the file is what the likelihood was computed with."""
    family = form.family(location, spread)
    for key, value in form.parameters(location, spread).items():
        assert float(getattr(family, key)) == pytest.approx(value)


@given(st.floats(-2, 3), st.floats(0.05, 1))
def test_a_gamma_has_this_mean_and_sd(location: float, spread: float) -> None:
    """The location is the log of the mean, the spread the SD over the mean."""
    p = GammaForm().parameters(location, spread)
    mean = p["shape"] * p["scale"]
    assert np.log(mean) == pytest.approx(location, abs=1e-9)
    assert np.sqrt(p["shape"]) * p["scale"] / mean == pytest.approx(spread)


def test_limits_and_tails_are_those_of_the_template() -> None:
    """The form of a configuration has its limits, the form of all the widest; a uniform has none."""
    two = np.array([1.0, 2.0])
    normal = Normal(two, two, np.array([0.0, 1.0]), np.array([5.0, np.inf]))
    assert form_of(normal, (0,)) == NormalForm(0.0, 5.0)
    assert form_of(normal, None) == NormalForm(0.0, np.inf)
    assert form_of(StudentT(two, two, np.array([3.0, 7.0])), (1,)) == StudentForm(7.0)
    assert form_of(Gamma(two, two), (1,)) == GammaForm()
    assert form_of(LogNormal(two, two), None) == LogNormalForm()
    assert form_of(Uniform(two - 2, two), None) is None
