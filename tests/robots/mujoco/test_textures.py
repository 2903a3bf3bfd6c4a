import numpy as np
import pytest

from palpate.robots.mujoco.textures import PATTERNS

LIGHT, DARK = (240.0, 200.0, 60.0), (60.0, 40.0, 20.0)


@pytest.mark.parametrize("name", PATTERNS)
def test_patterns_are_pictures_that_repeat(name: str) -> None:
    """Each pattern is a picture of both its colours, the same for the same seed and another for another."""
    first, again, other = (PATTERNS[name](np.random.default_rng(seed), LIGHT, DARK) for seed in (1, 1, 2))
    assert first.shape == (256, 256, 3)
    assert first.dtype == np.uint8
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.ptp(first[..., 0].astype(int)) > 30
