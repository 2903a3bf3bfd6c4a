from functools import reduce

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as npst

from palpate.store.exporting.lerobot.statistics import Moments, image_moments, moments

parts = st.lists(
    st.integers(1, 6).flatmap(lambda n: npst.arrays(np.float64, (n, 2), elements=st.floats(-1e6, 1e6))),
    min_size=1,
    max_size=5,
)


@given(parts)
def test_merged_is_as_all_at_once(values: list[np.ndarray]) -> None:
    """Statistics that are merged part by part are those of all values."""
    found = reduce(Moments.merged, map(moments, values)).plain()
    together = np.concatenate(values)
    assert found["count"] == [len(together)]
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(found[name], getattr(np, name)(together, axis=0), rtol=1e-6, atol=1e-6)


def test_large_means_lose_no_digits() -> None:
    """A spread that is small beside the mean is right to many digits."""
    values = 1e9 + np.random.default_rng(1).normal(size=(1000, 1))
    found = reduce(Moments.merged, (moments(part) for part in np.split(values, 10))).plain()
    np.testing.assert_allclose(found["std"], np.std(values, axis=0), rtol=1e-6)


@given(npst.arrays(np.uint8, (3, 4, 3)), st.integers(1, 5))
def test_an_image_counts_in_each_frame(pixels: np.ndarray, frames: int) -> None:
    """An image that is shown in several frames has the statistics of so many images."""
    found = image_moments(pixels, frames).plain()
    shown = np.stack([pixels.transpose(2, 0, 1) / 255.0] * frames)
    assert found["count"] == [frames]
    for name in ("min", "max", "mean", "std"):
        np.testing.assert_allclose(
            found[name], getattr(np, name)(shown, axis=(0, 2, 3)).reshape(3, 1, 1), rtol=1e-9, atol=1e-12
        )
