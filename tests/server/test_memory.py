"""The memory that samples take has an end, whoever asks for them at once, and however slowly they are read."""

import io
import time
import tracemalloc
from collections.abc import Callable
from dataclasses import replace
from http.client import IncompleteRead
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import urlopen
from uuid import UUID

import numpy as np
import pytest
from fastapi import FastAPI
from fastapi.testclient import TestClient

from palpate.server import packages
from palpate.server.api import recordings as served_recordings
from palpate.server.api.series import LARGEST_READ_BYTES, UNPACKED
from palpate.server.app import application
from palpate.server.packages import write_package
from palpate.server.security import rooms
from palpate.server.security.rooms import Room
from palpate.server.state import MOST_HELD_BYTES_OF_A_NETWORK
from palpate.store.errors import DamagedError
from palpate.store.importing.package import unpack
from palpate.store.keeping_episodes import put_episode
from palpate.store.parts import Head, head_of, series_of
from palpate.store.records import Channel, FileItem, Recording, Series
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from tests.server.conftest import SMALL
from tests.server.holders import Somebody
from tests.server.serving import listening
from tests.store.made_up import made_episode, squeeze

API = "/api/v1/recordings"
ONE_KIND = pytest.mark.parametrize("store", ["sqlite"], indirect=True)
MB = 1 << 20
OTHERS = Somebody()


def with_room(store: Store, most: int) -> tuple[FastAPI, Room]:
    app, room = application(store, SMALL), Room(most, most)
    app.state.palpate = replace(app.state.palpate, memory=room)
    return app, room


def addresses(recording: Recording, episode: UUID) -> list[str]:
    """All that reads samples, and logs and explorations, which may be long."""
    series, page = f"{API}/{recording.id}/series/0", f"/recordings/{recording.id}"
    figures = [f"{page}/series/0/{name}" for name in ("channels/0/plot.json", "channels/0/spectrogram.png")]
    forms = [f"{series}?format={form}" for form in ("json", "csv", "arrow")]
    wholes = [f"{API}/{recording.id}/{part}" for part in ("log", "package")]
    return [*forms, f"{series}/channels/0/sound", *wholes, page, *figures, f"/api/v1/episodes/{episode}"]


@ONE_KIND
def test_what_reads_samples_takes_memory_and_gives_it_back(store: Store) -> None:
    """Each of them is told to ask again where others have it, and leaves nothing taken behind."""
    sound = Channel("sound", "sound pressure", "Pa", np.arange(4000, dtype=np.int16), rate_hz=8000.0)
    recording = squeeze(visibility="public", series=(Series("microphone", (sound,)),), log="weighed\n")
    store.put(recording)
    episode = made_episode(visibility="public")
    put_episode(store, episode)
    app, room = with_room(store, 1 * MB)
    with TestClient(app) as client:
        for address in addresses(recording, episode.id):
            assert client.get(address).status_code == 200, address
            assert room.enter_alone(OTHERS, 1 * MB), address
            refused = client.get(address)
            assert (refused.status_code, refused.headers["retry-after"]) == (503, "5"), address
            room.leave(OTHERS)
        assert client.get(f"/compare/curves.json?recording={recording.id}").status_code == 200
        assert room.enter_alone(OTHERS, 1 * MB)
        assert client.get(f"/compare/curves.json?recording={recording.id}").status_code == 503
        assert client.get(f"{API}/{recording.id}").status_code == 200


@ONE_KIND
def test_memory_is_held_until_the_last_byte(store: Store) -> None:
    """Who reads slowly keeps it, as samples are there so long; who goes away gives it back."""
    values = np.random.default_rng(1).normal(size=300_000)
    recording = squeeze(visibility="public", series=(Series("arm", (Channel("force", "force", "N", values),)),))
    store.put(recording)
    app, room = with_room(store, 8 * MB)
    size = UNPACKED * values.nbytes
    with listening(app) as address:
        with urlopen(f"{address}{API}/{recording.id}/series/0?format=arrow") as slow:
            slow.read(10)
            assert not room.enter_alone(OTHERS, 1)
            assert not room.enter(OTHERS, 8 * MB - size + 1)
        wait_until(lambda: room.enter_alone(OTHERS, 1))


@ONE_KIND
def test_who_does_not_read_loses_memory_to_others(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """As soon as others need it, and before that they wait; whoever reads what he got finds that it ends."""
    monkeypatch.setattr(rooms, "LONGEST_WAIT_S", 0.5)
    monkeypatch.setattr(rooms, "SHORTEST_WAIT_S", 0.5)
    values = np.random.default_rng(1).normal(size=600_000)
    recording = squeeze(visibility="public", series=(Series("arm", (Channel("force", "force", "N", values),)),))
    store.put(recording)
    app, _ = with_room(store, UNPACKED * values.nbytes + MB // 2)
    with listening(app) as address:
        asked = f"{address}{API}/{recording.id}/series/0?format=arrow"
        with urlopen(asked) as slow:
            with pytest.raises(HTTPError, match="503"):
                urlopen(asked).close()
            time.sleep(1.0)
            with urlopen(asked) as quick:
                whole = len(quick.read())
            with pytest.raises((IncompleteRead, ConnectionError)):
                assert len(slow.read()) == whole


def wait_until(holds: Callable[[], bool]) -> None:
    end_s = time.monotonic() + 10
    while not holds():
        assert time.monotonic() < end_s
        time.sleep(0.02)


def test_the_largest_series_fits() -> None:
    """One address may have it, alone."""
    assert UNPACKED * LARGEST_READ_BYTES <= MOST_HELD_BYTES_OF_A_NETWORK


def test_a_package_is_made_with_one_part_in_memory(store: Store, tmp_path: Path) -> None:
    """However many parts there are; it is read back to what was put."""
    rng = np.random.default_rng(1)
    series = tuple(
        Series(f"arm {n}", (Channel("force", "force", "N", rng.normal(size=(MB // 8)), rate_hz=1e3),))
        for n in range(12)
    )
    files = tuple(FileItem(f"{n}.bin", "application/octet-stream", rng.bytes(MB)) for n in range(12))
    recording = squeeze(visibility="public", series=series, files=files, log="weighed\n" * 9)
    store.put(recording)
    head = head_of(store, Viewer(), recording.id)
    assert head is not None
    with (tmp_path / "package.zip").open("w+b") as file:
        tracemalloc.start()
        write_package(store, head, file)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert peak < 8 * MB, f"{peak / MB} MB of {(12 + 12)} MB"
        file.seek(0)
        found = unpack(file, lambda: tmp_path)
    assert found.digest == recording.digest
    assert (found.id, found.visibility, found.log, len(found.files)) == (recording.id, "public", recording.log, 12)


@ONE_KIND
def test_a_package_of_damaged_samples_is_none(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is stored is verified as a whole before any of it is sent."""
    recording = squeeze(visibility="public")
    store.put(recording)
    head = head_of(store, Viewer(), recording.id)
    assert head is not None

    def other(store: Store, head: Head, position: int) -> Series | None:
        found = series_of(store, head, position)
        assert found is not None
        first = found.channels[0]
        return replace(found, channels=(replace(first, values=first.values + 1.0), *found.channels[1:]))

    monkeypatch.setattr(packages, "series_of", other)
    with pytest.raises(DamagedError, match="digest"):
        write_package(store, head, io.BytesIO())
    monkeypatch.setattr(packages, "series_of", lambda *_: None)
    with pytest.raises(DamagedError, match="series 0 is missing"):
        write_package(store, head, io.BytesIO())


@ONE_KIND
def test_a_package_with_a_very_large_series_is_for_accounts(
    store: Store, token: Callable[..., Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Alone, as it may take more memory than there is for others."""
    recording = squeeze(visibility="public")
    store.put(recording)
    monkeypatch.setattr(served_recordings, "LARGEST_READ_BYTES", 999)
    app, room = with_room(store, 10)
    address, mine = f"{API}/{recording.id}/package", token("ann")
    with TestClient(app) as client:
        refused = client.get(address)
        assert refused.status_code == 403
        assert "expected 999 at most for those without an account" in refused.json()["detail"]
        assert client.get(address, headers=mine).status_code == 200
        assert room.enter(OTHERS, 1)
        assert client.get(address, headers=mine).status_code == 503
