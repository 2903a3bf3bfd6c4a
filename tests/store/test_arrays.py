from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.arrays import pack_bytes, pack_series, unpack_bytes, unpack_series
from palpate.store.content import layout_plain
from palpate.store.errors import DamagedError
from palpate.store.records import Channel, Series
from tests.store.made_up import series, squeeze


@given(series("sensor"))
def test_any_series_comes_back(one: Series) -> None:
    """Unpacking undoes packing, to the bit."""
    found = unpack_series(one.name, layout_plain(one), pack_series(one))
    for channel, other in zip(one.channels, found.channels, strict=True):
        assert channel.values.astype(channel.values.dtype.newbyteorder("<")).tobytes() == other.values.tobytes()
        assert channel.values.shape == other.values.shape
        assert (channel.time_s is None) == (other.time_s is None)
        if channel.time_s is not None and other.time_s is not None:
            assert np.array_equal(channel.time_s, other.time_s)


@given(st.integers(0), st.integers(1, 255))
def test_a_changed_byte_is_noticed(place: int, change: int) -> None:
    """Whichever byte of a packed series is changed, nothing wrong is returned."""
    one = squeeze().series[0]
    packed = bytearray(pack_series(one))
    packed[place % len(packed)] ^= change
    try:
        found = unpack_series(one.name, layout_plain(one), bytes(packed))
    except DamagedError:
        return
    assert found == one


@pytest.mark.parametrize("cut", [0, 1, 10, -1])
def test_cut_off_bytes_are_refused(cut: int) -> None:
    """Bytes that end early, or go on, are damaged."""
    one = squeeze().series[0]
    packed = pack_series(one)
    with pytest.raises(DamagedError):
        unpack_series(one.name, layout_plain(one), packed[:cut])
    with pytest.raises(DamagedError):
        unpack_series(one.name, layout_plain(one), packed + b"x")


def test_a_layout_must_fit() -> None:
    """Bytes of another layout are damaged, whichever of the two asks for more."""
    one = squeeze().series[0]
    layout: list[dict[str, Any]] = layout_plain(one)
    for wrong in (layout[:2], [*layout, layout[0]], [{**layout[0], "dtype": "<f4"}, *layout[1:]]):
        with pytest.raises(DamagedError):
            unpack_series(one.name, wrong, pack_series(one))


def test_threads_do_not_share_contexts() -> None:
    """Eight threads that compress and decompress at once get back what each put in."""
    rng = np.random.default_rng(0)
    many = [rng.integers(0, 9, 20_000, dtype=np.uint8).tobytes() for _ in range(64)]
    with ThreadPoolExecutor(8) as threads:
        assert list(threads.map(lambda data: unpack_bytes(pack_bytes(data)), many)) == many


def test_a_smooth_signal_takes_less() -> None:
    """Shuffled bytes of a smooth signal take less than compressed plain ones."""
    smooth = np.sin(np.linspace(0, 3, 1000))
    one = Series("sensor", (Channel("sine", "level", None, smooth),))
    assert len(pack_series(one)) < len(pack_bytes(smooth.tobytes()))
