import io

import matplotlib.image
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from palpate.store.errors import StoreError
from palpate.store.pictures import png


@given(hnp.arrays(np.uint8, st.tuples(st.integers(1, 5), st.integers(1, 5), st.sampled_from([3, 4]))))
def test_pictures_are_kept_without_loss(picture: np.ndarray) -> None:
    """Another library reads the very pixels that were given."""
    found = matplotlib.image.imread(io.BytesIO(png(picture, "here")), format="png")
    assert (np.rint(found * 255).astype(np.uint8) == picture).all()


def test_depth_images_have_16_bits() -> None:
    """A picture of uint16 comes back with its values."""
    depth = np.arange(6, dtype=np.uint16).reshape(2, 3) * 10_000
    found = matplotlib.image.imread(io.BytesIO(png(depth, "here")), format="png")
    assert (np.rint(found * 65535) == depth).all()


def test_another_type_is_refused() -> None:
    """Samples that are neither of 8 nor of 16 bits are refused with their type."""
    with pytest.raises(StoreError, match=r"here: .*float64"):
        png(np.zeros((2, 2)), "here")  # type: ignore[arg-type]
