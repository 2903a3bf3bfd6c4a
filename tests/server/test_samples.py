"""Samples of long recordings: sent in pieces, whole and in part, and refused where they are too many to be read."""

import io
import tracemalloc
import wave
from collections.abc import Iterable, Iterator

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from palpate.server.api import series as served_series
from palpate.server.api.arrows import arrow_pieces
from palpate.server.api.sounds import SoundFile, is_sound
from palpate.store.parts import head_of
from palpate.store.records import Channel, Series
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from tests.store.made_up import squeeze

API = "/api/v1/recordings"
MB = 1 << 20
LONG = 3_000_000


def peak_bytes(pieces: Iterable[bytes]) -> tuple[int, int]:
    """The most memory that making pieces takes beside what was there, and how many bytes there are."""
    before, sent, most = pa.total_allocated_bytes(), 0, 0
    tracemalloc.start()
    for piece in pieces:
        sent += len(piece)
        most = max(most, pa.total_allocated_bytes() - before)
    peak = tracemalloc.get_traced_memory()[1] + most
    tracemalloc.stop()
    return peak, sent


def test_a_long_channel_takes_little_memory() -> None:
    """As Arrow and as a sound no more than some pieces of it are there at once."""
    channel = Channel("sound", "sound pressure", "Pa", np.zeros(LONG, dtype=np.int8), rate_hz=44_100.0)
    # what is loaded once is not counted
    list(arrow_pieces(Series("microphone", (Channel("short", "force", "N", np.zeros(9)),))))
    peak, sent = peak_bytes(arrow_pieces(Series("microphone", (channel,))))
    assert sent > 24 * LONG
    assert peak < 16 * MB

    def sound() -> Iterator[bytes]:
        file = SoundFile(channel)
        yield from file.pieces(0, file.size)

    peak, sent = peak_bytes(sound())
    assert sent == 44 + 2 * LONG
    assert peak < 16 * MB


def test_pieces_are_the_whole_table() -> None:
    """Channels of several shapes, units and kinds of time are the rows that they are, over the ends of batches."""
    values = np.arange(140_000, dtype=np.float32).reshape(70_000, 2)
    times = np.linspace(0, 7, 9)
    channels = (
        Channel("torque", "torque", "Nm", values, rate_hz=1000.0),
        Channel("force", "force", None, np.arange(9), time_s=times),
        Channel("none", "force", "N", np.zeros((5, 0))),
        Channel("step", "torque", "Nm", np.array([4, 5])),
    )
    table = pa.ipc.open_stream(b"".join(arrow_pieces(Series("arm", channels)))).read_all()
    assert table["channel"].to_pylist() == ["torque"] * 140_000 + ["force"] * 9 + ["step"] * 2
    assert table["unit"].to_pylist() == ["Nm"] * 140_000 + [None] * 9 + ["Nm"] * 2
    assert np.array_equal(table["value"].to_numpy()[:140_000], values.ravel())
    assert np.array_equal(table["index"].to_numpy()[:140_000], np.repeat(np.arange(70_000), 2))
    assert np.array_equal(table["time_s"].to_numpy()[:140_000], np.repeat(np.arange(70_000) / 1000.0, 2))
    assert table["time_s"].to_pylist()[140_000:] == [*times.tolist(), None, None]
    empty = pa.ipc.open_stream(b"".join(arrow_pieces(Series("arm", ())))).read_all()
    assert (empty.num_rows, empty.schema.names) == (0, table.schema.names)


def test_any_part_of_a_sound_is_that_part() -> None:
    """Ranges over the ends of pieces and within a sample are what Python's slices say; the whole is a WAV file."""
    samples = np.random.default_rng(4).normal(size=600_000)
    samples[7] = np.nan
    file = SoundFile(Channel("sound", "sound pressure", "Pa", samples, rate_hz=8000.0))
    whole = b"".join(file.pieces(0, file.size))
    assert len(whole) == file.size
    with wave.open(io.BytesIO(whole)) as read:
        assert (read.getframerate(), read.getnframes()) == (8000, len(samples))
    for start, end in [(0, 10), (40, 47), (45, 46), (524_331, 524_340), (100_001, 1_100_000), (1_200_000, 1_200_044)]:
        assert b"".join(file.pieces(start, end)) == whole[start:end]
    assert file.beginning(12) == whole[:12]


def test_a_rate_that_no_sound_has_is_no_sound() -> None:
    """A WAV file has 32 bits for how many bytes a second there are."""
    assert not is_sound(Channel("sound", "sound pressure", "Pa", np.zeros(9), rate_hz=1e10))


def test_what_is_too_large_to_be_read_is_refused(
    client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As numbers, sound and figure alike, before it is read; in the package it is all there."""
    wide = Channel("camera", "intensity", None, np.zeros((10, 400), dtype=np.uint8), rate_hz=10.0)
    sound = Channel("sound", "sound pressure", "Pa", np.zeros(500, dtype=np.int16), rate_hz=8000.0)
    recording = squeeze(visibility="public", series=(Series("wide", (wide,)), Series("sound", (sound,))))
    store.put(recording)
    head = head_of(store, Viewer(), recording.id)
    assert head is not None
    assert [(one.numbers, one.size_bytes) for one in head.series] == [(4000, 4000), (500, 1000)]
    there = f"{API}/{recording.id}/series"
    asked = [f"{there}/0?format=arrow", f"{there}/0", f"{there}/1/channels/0/sound"]
    assert [client.get(address).status_code for address in asked] == [200] * 3
    monkeypatch.setattr(served_series, "LARGEST_READ_BYTES", 999)
    for address in [*asked, f"/recordings/{recording.id}/series/1/channels/0/spectrogram.png"]:
        refused = client.get(address)
        assert refused.status_code == 422
        assert "bytes, expected 999 at most" in refused.json()["detail"]
    assert client.get(f"{API}/{recording.id}/package").status_code == 200


BEYOND = (1 << 53) + 1
"""The first whole number that no double is."""


def kept(values: object, dtype: type) -> Channel:
    return Channel("stamp", "time", "ns", np.array(values, dtype=dtype), rate_hz=10.0)


@pytest.mark.parametrize(
    ("values", "dtype", "column"),
    [
        ([BEYOND, -BEYOND, np.iinfo(np.int64).min, np.iinfo(np.int64).max], np.int64, pa.int64()),
        ([BEYOND, np.iinfo(np.uint64).max], np.uint64, pa.uint64()),
        ([3, 4], np.int8, pa.int64()),
        ([0.5, np.nan], np.float32, pa.float64()),
        ([True, False], np.bool_, pa.int64()),
    ],
)
def test_whole_numbers_come_back_exact(
    client: TestClient, store: Store, values: list[object], dtype: type, column: pa.DataType
) -> None:
    """As Arrow in a column of whole numbers, and as JSON and CSV with all their digits."""
    recording = squeeze(visibility="public", series=(Series("clock", (kept(values, dtype),)),))
    store.put(recording)
    there = f"{API}/{recording.id}/series/0"
    table = pa.ipc.open_stream(client.get(there, params={"format": "arrow"}).content).read_all()
    assert table.schema.field("value").type == column
    np.testing.assert_array_equal(np.array(table["value"].to_pylist(), dtype=dtype), np.array(values, dtype=dtype))
    if dtype in (np.int64, np.uint64):
        assert client.get(there).json()["channels"][0]["values"] == values
        told = [line.rpartition(",")[2] for line in client.get(there, params={"format": "csv"}).text.split()[1:]]
        assert told == list(map(str, values))


@pytest.mark.parametrize(
    ("values", "dtype", "column"),
    [
        ([BEYOND, -BEYOND], np.int64, pa.int64()),
        ([BEYOND, np.iinfo(np.uint64).max], np.uint64, pa.uint64()),
        ([3, 1 << 53], np.int64, None),
    ],
)
def test_whole_numbers_beside_others_are_exact_too(values: list[int], dtype: type, column: pa.DataType | None) -> None:
    """Where a series has both, and a double cannot hold a whole number, it stands in a column of its own beside it."""
    force = Channel("force", "force", "N", np.array([0.5, 1.5]), rate_hz=10.0)
    pieces = arrow_pieces(Series("arm", (force, kept(values, dtype))))
    table = pa.ipc.open_stream(b"".join(pieces)).read_all()
    assert table["value"].to_pylist() == [0.5, 1.5, *map(float, values)]
    assert ("whole" in table.schema.names) == (column is not None)
    if column is not None:
        assert table.schema.field("whole").type == column
        assert table["whole"].to_pylist() == [None, None, *values]


def test_whole_numbers_of_both_signs_are_exact() -> None:
    """Those below zero and those beyond 63 bits in one series."""
    channels = (
        kept([-1, -BEYOND], np.int64),
        Channel("id", "id", None, np.array([2**64 - 1] * 2, np.uint64), rate_hz=10.0),
        Channel("contact", "contact", None, np.array([True, False]), rate_hz=10.0),
    )
    table = pa.ipc.open_stream(b"".join(arrow_pieces(Series("clock", channels)))).read_all()
    assert list(map(int, table["value"].to_pylist())) == [-1, -BEYOND, 2**64 - 1, 2**64 - 1, 1, 0]
