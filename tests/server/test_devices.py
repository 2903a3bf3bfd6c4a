"""Pages of devices and setups say what the store says: numbers of a calibration, those before it, and errors."""

import re
from dataclasses import replace
from html import unescape

from fastapi.testclient import TestClient

from palpate.server.benchmark import agreements
from palpate.server.plots.drawing import number
from palpate.store.describing import change_thing
from palpate.store.entries import Value
from palpate.store.records import Device, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_setups import seen_devices
from tests.store.made_up import squeeze

OLD = Device("gripper", "hand", "somebody", {"stroke_mm": 85, "soft": True}, {"offset_mm": 0.5}, "2024-01-02")
NEW = replace(OLD, calibration={"offset_mm": 0.25, "scale": {"n_per_a": 12.5}}, calibrated_on="2025-03-04")
ARM = Device("arm", "long arm", "others")


def words(page: str) -> str:
    """What a page says, tags left out."""
    return " ".join(unescape(re.sub(r"<[^>]*>", " ", page[page.index("<main") :])).split())


def digest_of(store: Store, device: Device) -> str:
    return next(one.digest for one in seen_devices(store, Viewer()) if one.device == device)


def test_a_device_shows_its_calibration_and_the_others(client: TestClient, store: Store) -> None:
    """Each number of its own, none of another calibration, and a link to each with how much was recorded by it."""
    setup = Setup(gripper=OLD, arm=ARM)
    for place, one in enumerate((setup, setup, Setup(gripper=NEW, arm=ARM))):
        store.put(squeeze(place, visibility="public", setup=one))
    page = client.get(f"/devices/{digest_of(store, NEW)}").text
    told = words(page)
    assert "hand gripper About it Maker somebody Recordings 1" in told
    assert "Parameters stroke mm 85 soft yes" in told or "Parameters soft yes stroke mm 85" in told
    assert "Made on 2025-03-04" in told
    assert "offset mm 0.25" in told
    assert "n per a 12.5" in told
    assert "0.5 " not in told
    assert "2024-01-02 : 2 recordings" in told
    assert "2025-03-04 , this one: 1 recording" in told
    assert f'href="/devices/{digest_of(store, OLD)}"' in page
    bare = words(client.get(f"/devices/{digest_of(store, ARM)}").text)
    assert "Made on not stated No numbers of it are stated." in bare


def test_a_setup_shows_each_of_its_devices(client: TestClient, store: Store) -> None:
    """With maker, parameters and the calibration that held, and the recordings that were made with it."""
    setup, other = Setup(gripper=OLD, arm=ARM), Setup(gripper=NEW)
    for place, one in enumerate((setup, setup, other)):
        store.put(squeeze(place, visibility="public", setup=one))
    page = client.get(f"/setups/{setup.digest}").text
    told = words(page)
    assert f"Setup {setup.digest[:8]} 2 recordings were made with these devices together." in told
    assert "hand gripper Maker somebody Calibrated 2024-01-02" in told
    assert "Calibration offset mm 0.5" in told
    assert "long arm arm Maker others Calibrated not stated" in told
    assert page.count('<td class="date">') == 2
    assert f'href="/devices/{digest_of(store, OLD)}"' in page
    assert f'href="/devices/{digest_of(store, NEW)}"' not in page
    assert "1 recording was made with these devices" in words(client.get(f"/setups/{other.digest}").text)


def test_errors_of_a_device_are_those_of_the_benchmark(client: TestClient, store: Store) -> None:
    """Its table has what is computed from the store: the mean, the spread and the root mean square of its errors."""
    for place, value in enumerate((40.0, 46.0, 53.0)):
        thing = ThingRef("lab", f"ball {place}")
        entry = Value("elasticity", value, 1.0, "kPa")
        store.put(squeeze(place, visibility="public", setup=Setup(gripper=OLD), thing=thing, entries=(entry,)))
        change_thing(store, thing, lambda known: known.knowing(Value("elasticity", 40.0, None, "kPa"), "a test"))
    (error,) = agreements(store, Viewer(), "elasticity").devices
    assert error.bias is not None
    assert abs(error.bias - 19 / 3) < 1e-9
    told = words(client.get(f"/devices/{digest_of(store, OLD)}").text)
    figures = " ".join(number(one) for one in (error.bias, error.sd or 0.0, error.rms or 0.0))
    assert f"elasticity [kPa] hand 3 3 0 3 0 {figures}" in told
