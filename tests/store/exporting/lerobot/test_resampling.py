import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst
from scipy.interpolate import interp1d

from palpate.store.exporting.lerobot.resampling import Linear, Nearest, Resampling

times = st.lists(st.integers(0, 1000), min_size=2, max_size=20, unique=True).map(sorted)
RULES = [Nearest(), Linear()]


@given(times, st.data())
def test_linear_is_as_in_scipy(stamps: list[int], data: st.DataObject) -> None:
    """Lines between samples are those that scipy draws."""
    time_s = np.array(stamps) / 8
    values = data.draw(npst.arrays(np.float64, (len(stamps), 2), elements=st.floats(-1e3, 1e3)))
    at_s = np.linspace(time_s[0], time_s[-1], 37)
    np.testing.assert_allclose(Linear()(at_s, time_s, values), interp1d(time_s, values, axis=0)(at_s), atol=1e-9)


@given(times, st.data())
def test_nearest_is_nearest(stamps: list[int], data: st.DataObject) -> None:
    """No sample is nearer than the one that is taken, and of two that are equally near it is the earlier."""
    time_s = np.array(stamps, dtype=np.float64)
    at_s = np.array(data.draw(st.lists(st.floats(stamps[0], stamps[-1]), max_size=9)))
    taken = Nearest()(at_s, time_s, time_s[:, None])[:, 0]
    for moment, found in zip(at_s, taken, strict=True):
        distances = [abs(stamp - moment) for stamp in stamps]
        assert found == stamps[distances.index(min(distances))]


@pytest.mark.parametrize("rule", RULES)
@given(values=npst.arrays(np.float64, (5, 3), elements=st.floats(-1e6, 1e6)))
def test_samples_at_their_own_times_stay(rule: Resampling, values: np.ndarray) -> None:
    """Resampling at the times of the samples gives the samples."""
    time_s = np.arange(5) / 100
    np.testing.assert_array_equal(rule(time_s, time_s, values), values)


@pytest.mark.parametrize("rule", RULES)
def test_one_sample_is_all_there_is(rule: Resampling) -> None:
    """A single sample is what every rule gives."""
    assert rule(np.array([2.0]), np.array([2.0]), np.array([[7.0]])).tolist() == [[7.0]]
