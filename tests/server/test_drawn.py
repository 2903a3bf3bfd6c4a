"""What pages read and draw of recordings has an end, whatever these hold; what is left out is said."""

from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from palpate.server.api.sounds import SoundFile
from palpate.server.pages import overlays, signals
from palpate.server.pages.allowance import MOST_DRAWN, MOST_FITTED, MOST_NUMBERS
from palpate.server.pages.signals import MOST_FILES, MOST_SERIES
from palpate.store.entries import Value
from palpate.store.parts import Head, series_of
from palpate.store.records import Channel, FileItem, Recording, Series, ThingRef
from palpate.store.store import Store
from tests.store.made_up import squeeze

pytestmark = pytest.mark.parametrize("store", ["sqlite"], indirect=True)
THIRD = MOST_NUMBERS // 3 + 1


@pytest.fixture
def read(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many numbers each series has that a page reads."""
    found: list[int] = []

    def counted(store: Store, head: Head, position: int) -> Series | None:
        series = series_of(store, head, position)
        found.append(0 if series is None else sum(one.values.size for one in series.channels))
        return series

    for module in (signals, overlays):
        monkeypatch.setattr(module, "series_of", counted)
    return found


def channel(numbers: int, width: int = 1, name: str = "load") -> Channel:
    values = np.zeros((numbers // width, width) if width > 1 else numbers, dtype=np.int8)
    return Channel(name, "mass", "g", values, rate_hz=50.0)


def put(store: Store, *series: Series, number: int = 0, **options: Any) -> Recording:
    recording = squeeze(number, visibility="public", series=series, **options)
    store.put(recording)
    return recording


def page(client: TestClient, address: str) -> str:
    found = client.get(address, headers={"Accept": "text/html"})
    assert found.status_code == 200, found.text
    return found.text


def test_a_page_of_a_recording_reads_so_many_numbers(client: TestClient, store: Store, read: list[int]) -> None:
    """Of many series and of wide samples alike; what is smaller is drawn all the same."""
    wide = Series("wide", (channel(MOST_NUMBERS + 400, width=400),))
    thirds = [Series(f"third {place}", (channel(THIRD),)) for place in range(4)]
    recording = put(store, wide, *thirds, Series("small", (channel(90),)))
    text = page(client, f"/recordings/{recording.id}")
    assert read == [THIRD, THIRD, 90]
    assert text.count(f"numbers, and a page reads {MOST_NUMBERS:,} at most") == 3
    assert f"it has {MOST_NUMBERS + 400:,} numbers" in text
    assert text.count('<figure class="wide plotted"') == 3
    assert f'href="/api/v1/recordings/{recording.id}/package">All of the recording' in text


def test_a_page_of_a_recording_draws_so_many_plots(client: TestClient, store: Store) -> None:
    """Very many small series and files are no page of their own each."""
    many = [Series(f"series {place}", (channel(2), channel(2, name="other"))) for place in range(MOST_SERIES + 2)]
    files = [FileItem(f"{place}.txt", "text/plain", b"x") for place in range(MOST_FILES + 1)]
    recording = put(store, *many, files=tuple(files))
    text = page(client, f"/recordings/{recording.id}")
    assert text.count('<figure class="wide plotted"') == MOST_DRAWN
    assert "2 more series are not shown here" in text
    assert "1 more file is not shown here" in text
    assert [f"{MOST_FILES - 1}.txt" in text, f"{MOST_FILES}.txt" in text] == [True, False]


def test_lines_are_fitted_to_so_many_samples(client: TestClient, store: Store) -> None:
    """Fitting takes long, so that one very long squeeze, or very many, would keep a server busy for minutes."""

    def pressed(samples: int, name: str) -> Series:
        gap, force = np.linspace(50.0, 40.0, samples), np.maximum(0.0, np.linspace(-1.0, 20.0, samples))
        channels = (
            Channel("gap", "length", "mm", gap, rate_hz=1e3),
            Channel("force", "force", "N", force, rate_hz=1e3),
        )
        return Series(name, channels)

    recording = put(store, pressed(MOST_FITTED + 1, "long"), *(pressed(MOST_FITTED // 2 - 1, f"{n}") for n in range(3)))
    text = page(client, f"/recordings/{recording.id}")
    assert text.count(f"a page fits lines to {MOST_FITTED:,} samples at most") == 2
    assert text.count("The squeeze, and the line fitted") == 2
    figures = [client.get(f"/recordings/{recording.id}/series/{place}/squeeze.json") for place in (0, 3)]
    assert [one.status_code for one in figures] == [404, 200]


def test_sounds_in_files_are_numbers_too(client: TestClient, store: Store) -> None:
    """They are heard in any case, and drawn as far as is left."""
    heard = SoundFile(Channel("sound", "sound pressure", "Pa", np.zeros(THIRD, dtype=np.int16), rate_hz=8000.0))
    sound = b"".join(heard.pieces(0, heard.size))
    files = tuple(FileItem(f"{place}.wav", "audio/wav", sound + bytes(2 * place)) for place in range(4))
    recording = put(store, files=files)
    text = page(client, f"/recordings/{recording.id}")
    assert (text.count("<audio"), text.count('<figure class="wide plotted"')) == (4, 2)


@pytest.mark.parametrize("figure", ["channels/0/plot.json", "squeeze.json", "channels/0/spectrogram.png"])
def test_a_figure_of_too_much_is_refused(client: TestClient, store: Store, read: list[int], figure: str) -> None:
    """By a sentence that names the field, before anything is read."""
    recording = put(store, Series("wide", (channel(MOST_NUMBERS + 400, width=400),)))
    refused = client.get(f"/recordings/{recording.id}/series/0/{figure}")
    assert refused.status_code == 422
    (error,) = refused.json()["errors"]
    assert error["field"] == "path.position"
    assert f"has {MOST_NUMBERS + 400} numbers, expected {MOST_NUMBERS} at most" in error["detail"]
    assert read == []


def test_curves_over_each_other_read_so_many_numbers(client: TestClient, store: Store, read: list[int]) -> None:
    """All recordings together; those that are left out are named, with where they are."""
    thing = ThingRef("lab", "mug")
    series: list[tuple[Series, ...]] = [(Series("arm", (channel(THIRD),)), Series("more", (channel(THIRD),)))] * 4
    series.append((Series("wide", (channel(MOST_NUMBERS + 400, width=400),)),))
    entries = (Value("mass", 118.0, 1.0, "g"),)
    found = [put(store, *one, number=place, thing=thing, entries=entries) for place, one in enumerate(series)]
    chosen = "&".join(f"recording={one.id}" for one in found)
    text = page(client, f"/compare?property=mass&object=lab/mug&{chosen}")
    assert read == [THIRD, THIRD]
    assert text.count("/package") == 3
    assert f"a page reads {MOST_NUMBERS:,} numbers at most" in text
    assert f'href="/api/v1/recordings/{found[-1].id}/package"' in text
    del read[:]
    assert client.get(f"/compare/curves.json?{chosen}").status_code == 200
    assert read == [THIRD, THIRD]
