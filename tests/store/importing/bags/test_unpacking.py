import bz2
from collections.abc import Callable
from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import pytest
import zstandard
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.importing.bags.unpacking import unbz2, unlz4, unzstd, unzstd_file

PAIRS: list[tuple[Callable[[bytes], bytes], Callable[..., bytes]]] = [
    (zstandard.compress, unzstd),
    (lz4.frame.compress, unlz4),
    (bz2.compress, unbz2),
]


@pytest.mark.parametrize(("pack", "unpack"), PAIRS)
@given(st.binary(max_size=200))
def test_what_was_packed_comes_out(pack: Callable[[bytes], bytes], unpack: Callable[..., bytes], data: bytes) -> None:
    """Each way of packing is undone, also up to the very limit."""
    assert unpack(pack(data), "here") == data
    assert unpack(pack(data), "here", len(data)) == data


@pytest.mark.parametrize(("pack", "unpack"), PAIRS)
def test_what_holds_too_much_is_refused(pack: Callable[[bytes], bytes], unpack: Callable[..., bytes]) -> None:
    """More than the limit is never made, whatever the packed bytes say of their size."""
    with pytest.raises(StoreError, match="here: more than 1000 bytes when it is unpacked"):
        unpack(pack(bytes(10_000_000)), "here", 1000)


@pytest.mark.parametrize(("pack", "unpack"), PAIRS)
@given(st.integers(0, 200), st.integers(1, 255))
def test_damage_is_one_sentence(
    pack: Callable[[bytes], bytes], unpack: Callable[..., bytes], place: int, change: int
) -> None:
    """A changed byte or a missing end is a StoreError, or bytes."""
    data = b"the robot squeezes the mug" * 20
    packed = bytearray(pack(data))
    packed[place % len(packed)] ^= change
    try:
        found = unpack(bytes(packed), "here")
    except StoreError as error:
        found = str(error).encode()
    assert found.startswith((b"here: ", b"the robot")) or len(found) <= len(data)
    with pytest.raises(StoreError, match=r"here: .* cannot be unpacked"):
        unpack(pack(data)[:-3], "here")


def test_files_are_unpacked_with_a_limit(tmp_path: Path) -> None:
    """A file is unpacked piece by piece, and no further than the limit."""
    packed = tmp_path / "a.zstd"
    packed.write_bytes(zstandard.compress(bytes(3_000_000)))
    unzstd_file(packed, tmp_path / "a")
    assert (tmp_path / "a").stat().st_size == 3_000_000
    with pytest.raises(StoreError, match=r"a\.zstd: more than 1000 bytes"):
        unzstd_file(packed, tmp_path / "b", 1000)
    packed.write_bytes(b"no zstd")
    with pytest.raises(StoreError, match="cannot be unpacked"):
        unzstd_file(packed, tmp_path / "c")
