"""What the service tells is what the store holds."""

import csv
import io
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from threading import Event
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from fastapi.testclient import TestClient

from palpate.network import units
from palpate.server.api import models
from palpate.server.app import application
from palpate.server.repeated import LISTS
from palpate.store.describing import change_thing, keep_image
from palpate.store.entries import Distribution, Value
from palpate.store.keeping_episodes import put_episode
from palpate.store.merging import merge_things
from palpate.store.records import Channel, Device, FileItem, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from tests.server.conftest import SMALL
from tests.store.made_up import START, made_episode, squeeze

API = "/api/v1"
PNG = b"\x89PNG\r\n\x1a\n and so on"


def public(number: int = 0, **changes: object) -> Recording:
    return squeeze(number, **{"visibility": "public", **changes})


def test_pages_follow_each_other_without_gap_or_repetition(client: TestClient, store: Store) -> None:
    """All rows come once, the last recorded first, also while more are added."""
    put = [public(number) for number in range(7)]
    store.put_many(put)
    found, address = [], f"{API}/recordings?limit=3"
    while address:
        answer = client.get(address)
        found += [item["digest"] for item in answer.json()["items"]]
        store.put(public(100 + len(found), recorded_at=START + timedelta(days=1)))
        address = answer.links.get("next", {}).get("url", "")
    assert found == [one.digest for one in reversed(put)]


def test_who_pages_on_in_the_order_of_uploads_misses_nothing(client: TestClient, store: Store) -> None:
    """An upload that began before and is kept later stands in front: those after it are listed once it is there."""
    asked = f"{API}/recordings?sort=uploaded&order=ascending&limit=2"
    # all of one object and setup, which who puts the second one knows already
    put = [public(number, thing=ThingRef("lab", "cup")) for number in range(4)]
    drawn, go_on = Event(), Event()
    draw = store._statements.new_ids

    def slowly(*args: Any) -> Any:
        ids = draw(*args)
        drawn.set()
        assert go_on.wait(30)
        return ids

    with Store(store.engine, store.blobs) as slow, ThreadPoolExecutor(2) as pool, pytest.MonkeyPatch.context() as patch:
        store.put(put[0])
        slow.put(put[1])
        first = client.get(asked).json()
        assert [item["digest"] for item in first["items"]] == [one.digest for one in put[:2]]
        following = f"{asked}&cursor={first['next']}"
        patch.setattr(slow._statements, "new_ids", slowly)
        kept = [pool.submit(slow.put, put[2])]
        assert drawn.wait(30)
        # a file has one writer at a time, and the other one waits
        kept.append(pool.submit(store.put, put[3]))
        if store.engine.dialect.name == "postgresql":
            kept[1].result(30)
        meanwhile = client.get(following).json()
        go_on.set()
        for one in kept:
            one.result(30)
    assert (meanwhile["items"], meanwhile["next"]) == ([], None)
    assert [item["digest"] for item in client.get(following).json()["items"]] == [one.digest for one in put[2:]]


def test_a_recording_is_told_whole(client: TestClient, store: Store) -> None:
    """A recording has all its fields, and leads to its samples."""
    recording = public(3, notices=("cold",), log="closing\n")
    store.put(recording)
    plain = client.get(f"{API}/recordings/{recording.id}").json()
    assert client.get(f"{API}/recordings/{recording.digest}").json() == plain
    assert models.Recording.model_validate(plain).digest == recording.digest
    assert plain["entries"] == [{"kind": "value", "property": "elasticity", "value": 43.0, "sd": 10.0, "unit": "kPa"}]
    assert plain["setup"] == recording.setup.digest
    assert client.get(f"{plain['url']}/log").text == "closing\n"
    samples = client.get(plain["series"][0]["url"]).json()
    for told, channel in zip(samples["channels"], recording.series[0].channels, strict=True):
        assert np.array_equal(np.array(told["values"], channel.values.dtype), channel.values)


def test_samples_as_csv_and_arrow(client: TestClient, store: Store) -> None:
    """Both tables hold the same numbers as the series, with their times, and null or empty where there is none."""
    values = np.array([1.5, np.nan, -2.0])
    series = Series("gripper", (Channel("=force", "force", "N", values, rate_hz=10.0),))
    recording = public(series=(series,))
    store.put(recording)
    address = f"{API}/recordings/{recording.id}/series/0"
    rows = list(csv.DictReader(io.StringIO(client.get(f"{address}?format=csv").text)))
    assert [row["value"] for row in rows] == ["1.5", "nan", "-2.0"]
    assert [float(row["time_s"]) for row in rows] == [0.0, 0.1, 0.2]
    # a spreadsheet would take it for a formula
    assert rows[0]["channel"] == "'=force"
    table = pa.ipc.open_stream(client.get(f"{address}?format=arrow").content).read_all()
    assert np.array_equal(table["value"].to_numpy(), values, equal_nan=True)
    assert table["channel"].to_pylist() == ["=force"] * 3
    assert client.get(address).json()["channels"][0]["values"] == [1.5, None, -2.0]


def test_a_sound_can_be_heard(client: TestClient, store: Store) -> None:
    """A channel of many samples a second is a WAV file of so many; another one is none."""
    tone = np.sin(np.arange(8000) / 5)
    channels = (
        Channel("left", "sound pressure", None, tone, rate_hz=8000.0),
        Channel("force", "force", "N", np.zeros(9), rate_hz=9.0),
    )
    recording = public(series=(Series("microphone", channels),))
    store.put(recording)
    address = f"{API}/recordings/{recording.id}/series/0/channels"
    sound = client.get(f"{address}/0/sound")
    assert sound.headers["content-type"] == "audio/wav"
    samples = np.frombuffer(sound.content[44:], "<i2")
    assert np.allclose(samples / 32767, tone / np.abs(tone).max(), atol=1e-4)
    assert int.from_bytes(sound.content[24:28], "little") == 8000
    assert client.get(f"{address}/1/sound").status_code == 404


@pytest.mark.parametrize(
    ("asked", "expected"),
    [
        ("object=object1", {1, 4}),
        ("dataset=made_up&limit=2", {4, 5}),
        ("action=weighing", {5}),
        ("property=mass", {5}),
        ("gripper=other", {4}),
        ("device=other", {4}),
        ("owner=ann", {0}),
        ("ground_truth=true", {3}),
        ("text=COLD", {2}),
        ("since=2024-05-01T12:00:04Z", {4, 5}),
        ("until=2024-05-01T12:00:01", {0}),
        ("label=material:wood", {1}),
        ("known=material:metal", {2, 5}),
        ("material=metal", {2, 5}),
        ("known=material:wood&known=material:metal", set()),
        ("known=material:wood&material=metal", set()),
        ("label=material:foam&label=material:wood", set()),
        ("label=material:wood&label=material:wood", {1}),
        ("sort=recorded&order=ascending&limit=1", {0}),
        ("action=&owner=", {0, 1, 2, 3, 4, 5}),
    ],
)
def test_filters(client: TestClient, store: Store, asked: str, expected: set[int]) -> None:
    """Each filter lets through what it says."""
    changes: list[dict[str, object]] = [
        {"owner": "ann"},
        {"entries": (Distribution("material", {"wood": 0.9, "foam": 0.1}),)},
        {"notices": ("a cold room",)},
        {"ground_truth": True},
        {"setup": Setup(gripper=Device("gripper", "other"))},
        {"action": "weighing", "entries": (Value("mass", 5.0, None, "g"),)},
    ]
    put = [public(number, **change) for number, change in enumerate(changes)]
    store.put_many(put)
    metal = Distribution("material", {"metal": 1.0})
    change_thing(store, put[2].thing, lambda thing: thing.knowing(metal, "a label"))
    found = {item["digest"] for item in client.get(f"{API}/recordings?{asked}").json()["items"]}
    assert found == {put[number].digest for number in expected}


@pytest.mark.parametrize(
    "address", [f"{API}/recordings", f"{API}/entries", f"{API}/objects", "/recordings", "/objects"]
)
def test_a_filter_of_one_value_is_given_once(client: TestClient, address: str) -> None:
    """Else one of the two would be passed over, and nobody would notice; what is refused is named."""
    for asked in ("action=weighing&action=knocking", "action=weighing&action=", "action=weighing&action=weighing"):
        refused = client.get(f"{address}?{asked}&limit=5")
        assert (refused.status_code, refused.json()["detail"]) == (422, "action: is given 2 times, expected once")
        assert [one["field"] for one in refused.json()["errors"]] == ["query.action"]
    page = client.get("/recordings?owner=a&owner=b", headers={"Accept": "text/html"})
    assert (page.status_code, "owner: is given 2 times, expected once" in page.text) == (422, True)


@pytest.mark.parametrize(
    "address",
    ["recordings", "recordings/{key}", "recordings/{key}/files", "objects/made_up/object0", "properties", "setups"],
)
def test_a_parameter_that_is_not_known_is_refused_everywhere(client: TestClient, store: Store, address: str) -> None:
    """One item is asked for as a list is: what would be passed over is named; what is known, or empty, is not."""
    key = store.put(public()).id
    place = f"{API}/{address.format(key=key)}"
    assert client.get(place).status_code == 200
    assert client.get(f"{place}?sorce=").status_code == 200
    refused = client.get(f"{place}?sorce=a&key={key}")
    assert (refused.status_code, refused.json()["errors"][0]["field"]) == (422, "query.sorce")
    assert "query.sorce: is not known here, leave it out" in refused.json()["detail"]
    whole = client.get(f"{API}/recordings/{key}?fields=id")
    assert (whole.status_code, whole.json()["detail"]) == (422, "query.fields: is not known here, leave it out")
    assert client.get(f"{API}/recordings/{key}/series/0?format=csv").status_code == 200


def test_what_may_be_given_several_times_is_what_lists_are(client: TestClient) -> None:
    """The document says which parameters of the service are lists, and no other may be repeated."""
    paths = client.get(f"{API}/openapi.json").json()["paths"]
    asked = [one for path in paths.values() for method in path.values() for one in method.get("parameters", ())]
    lists = {one["name"] for one in asked if one["in"] == "query" and one["schema"].get("type") == "array"}
    assert {"fields", "known", "label"} <= lists <= LISTS
    assert LISTS - lists == {"recording", "colour"}
    key = "0190a5c4-0000-7000-8000-000000000000"
    assert client.get(f"/compare?recording={key}&recording={key}").status_code == 200
    assert client.get(f"/compare/curves.json?recording={key}&recording={key}&colour=1&colour=1").status_code == 404


def test_fields_are_those_asked_for(client: TestClient, store: Store) -> None:
    """Only these fields, in this order; one that there is not is an error that names the others."""
    store.put(public())
    (item,) = client.get(f"{API}/recordings?fields=action,id").json()["items"]
    assert list(item) == ["action", "id"]
    (same,) = client.get(f"{API}/recordings?fields=action&fields=id").json()["items"]
    assert same == item
    wrong = client.get(f"{API}/recordings?fields=action,colour")
    assert wrong.status_code == 422
    assert wrong.json()["errors"][0]["field"] == "query.fields"
    assert "visibility" in wrong.json()["detail"]


def test_objects_with_all_that_is_known(client: TestClient, store: Store) -> None:
    """An object has its description, its pictures, and the recordings of those merged into it."""
    mug, cup = ThingRef("our/lab", "..", common_name="mug"), ThingRef("ycb", "cup")
    store.put_many([public(1, thing=mug), public(2, thing=cup)])
    merge_things(store, cup, mug)
    image = keep_image(store, "front.png", "image/png", PNG)
    mass = Value("mass", 118.0, 1.0, "g")
    change_thing(store, mug, lambda thing: thing.knowing(mass, "our scale").showing(image))
    (item,) = client.get(f"{API}/objects").json()["items"]
    assert models.Object.model_validate(item).recordings == 2
    assert client.get(item["url"]).json() == item
    assert item["merged"] == [{"dataset": "ycb", "name": "cup"}]
    assert item["known"] == [
        {"entry": {"kind": "value", "property": "mass", "value": 118.0, "sd": 1.0, "unit": "g"}, "source": "our scale"}
    ]
    picture = client.get(item["images"][0]["url"])
    assert (picture.content, picture.headers["content-type"]) == (PNG, "image/png")
    assert client.get(f"{API}/objects?text=MUG&property=elasticity&gripper=two_finger").json()["items"] == [item]
    assert client.get(f"{API}/objects?text=mug&action=weighing").json()["items"] == []


def test_pages_of_objects(client: TestClient, store: Store) -> None:
    """Objects come by data set and name, each once."""
    names = ["b", "a", "d", "c"]
    store.put_many([public(n, thing=ThingRef("made_up", name)) for n, name in enumerate(names)])
    found, address = [], f"{API}/objects?limit=3"
    while address:
        answer = client.get(address)
        found += [item["name"] for item in answer.json()["items"]]
        address = answer.links.get("next", {}).get("url", "")
    assert found == sorted(names)


@pytest.mark.parametrize("asked", ["objects?", "recordings?sort=action&", "recordings?sort=action&order=ascending&"])
def test_pages_follow_each_other_in_the_order_of_a_language(client: TestClient, store: Store, asked: str) -> None:
    """Small and large letters are mixed in dictionaries, and no row is told twice or left out there either."""
    if store.engine.dialect.name == "postgresql":
        with store.engine.begin() as connection:
            for table, column in (("things", "dataset"), ("things", "name"), ("recordings", "action")):
                change = f'ALTER TABLE {table} ALTER COLUMN {column} TYPE varchar COLLATE "en-x-icu"'
                connection.exec_driver_sql(change)
    names = ["a", "B", "c", "D", "e", "F"]
    put = [public(n, action=name, thing=ThingRef("made_up", name)) for n, name in enumerate(names)]
    store.put_many(put)
    found, address = [], f"{API}/{asked}limit=2"
    while address:
        answer = client.get(address)
        found += [item.get("action", item.get("name")) for item in answer.json()["items"]]
        address = answer.links.get("next", {}).get("url", "")
    expected = names if store.engine.dialect.name == "postgresql" else sorted(names)
    assert found == (expected[::-1] if asked.endswith("action&") else expected)


def test_entries_devices_setups_properties(client: TestClient, store: Store) -> None:
    """Each list has what the recordings are made of."""
    store.put_many(
        [public(1), public(2, entries=(Value("mass", 5.0, 1.0, "g"), Value("elasticity", 1.0, None, "kPa")))]
    )
    rows = client.get(f"{API}/entries?property=elasticity").json()["items"]
    assert [models.EntryRow.model_validate(row).value_si for row in rows] == [1000.0, 41000.0]
    (device,) = client.get(f"{API}/devices").json()["items"]
    assert models.Device.model_validate(device).recordings == 2
    (setup,) = client.get(f"{API}/setups").json()["items"]
    assert client.get(f"{API}/setups/{setup['digest']}").json() == setup
    assert models.Setup.model_validate(setup).devices[0].name == "two_finger"
    assert client.get(f"{API}/properties").json()["items"] == [
        {"name": "elasticity", "unit": "kPa", "entries": 2},
        {"name": "mass", "unit": "g", "entries": 1},
    ]


def test_a_unit_that_is_no_longer_known_spoils_no_list(
    client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What was kept by another version is told as it was given, and without a value in SI units."""
    with monkeypatch.context() as other:
        known = dict(units._shipped())
        other.setattr(units, "_shipped", lambda: {**known, "formerly": known["g"]})
        given = (Value("mass", 5.0, 1.0, "formerly"), Value("mass", 7.0, None, "g"))
        store.put(squeeze(visibility="public", entries=given))
    units.unit_of.cache_clear()
    rows = client.get(f"{API}/entries").json()["items"]
    assert [(row["value_si"], row["sd_si"], row["label"]) for row in rows] == [(None, None, None), (0.007, None, None)]
    assert rows[0]["entry"] == {"kind": "value", "property": "mass", "value": 5.0, "sd": 1.0, "unit": "formerly"}


def test_episodes_lead_to_their_recordings(client: TestClient, store: Store) -> None:
    """A step names the recording of its action by the id that the store has it under."""
    recording = public(1)
    store.put(recording)
    episode = made_episode(recording, stop="nothing is left", visibility="public")
    put_episode(store, episode)
    (row,) = client.get(f"{API}/episodes").json()["items"]
    plain = client.get(row["url"]).json()
    assert models.EpisodeRow.model_validate(row).stop == "nothing is left"
    assert models.Episode.model_validate(plain).digest == episode.digest
    assert [step["recording"] for step in plain["steps"]] == [str(recording.id), None]
    assert plain["header"] == episode.header


def test_a_part_of_a_file(client: TestClient, store: Store) -> None:
    """A range gives its bytes, one that is outside is an error, and one that cannot be read gives all."""
    recording = public(files=(FileItem("cam/front.png", "image/png", PNG),))
    store.put(recording)
    address = f"{API}/recordings/{recording.id}/files/0"
    whole = client.get(address)
    assert (whole.content, whole.headers["accept-ranges"]) == (PNG, "bytes")
    for asked, expected in [
        ("bytes=2-4", PNG[2:5]),
        ("bytes=5-", PNG[5:]),
        ("bytes=-3", PNG[-3:]),
        ("bytes=0-999", PNG),
    ]:
        part = client.get(address, headers={"Range": asked})
        assert (part.status_code, part.content) == (206, expected)
    assert client.get(address, headers={"Range": "bytes=99-"}).status_code == 416
    for odd in ("bytes=a-b", "lines=1-2", "bytes=1-2,4-5", "bytes=-", f"bytes={'9' * 5000}-"):
        assert client.get(address, headers={"Range": odd}).content == PNG
    assert client.get(address, headers={"If-None-Match": whole.headers["etag"]}).status_code == 304


def test_the_document_describes_what_is_there(client: TestClient) -> None:
    """The OpenAPI document has each address, and problems as the form of errors."""
    document = client.get(f"{API}/openapi.json").json()
    assert f"{API}/recordings/{{key}}" in document["paths"]
    listed = document["paths"][f"{API}/recordings"]["get"]
    assert {one["name"] for one in listed["parameters"]} >= {"limit", "cursor", "material", "since"}
    assert listed["responses"]["422"]["content"]["application/problem+json"]["schema"]["$ref"].endswith("/Problem")


def test_health_and_metrics(client: TestClient, token: Callable[..., dict[str, str]]) -> None:
    """Health is told, and requests are counted by route, not by what was asked."""
    assert client.get("/health").json() == {"status": "ok"}
    client.get(f"{API}/recordings/nothing")
    told = client.get("/metrics", headers=token("ann")).text
    assert "palpate_requests_total" in told
    assert "nothing" not in told


def test_metrics_are_for_this_computer(client: TestClient, store: Store) -> None:
    """From elsewhere they need a token."""
    assert client.get("/metrics").status_code == 401
    for here in ("127.0.0.1", "::1"):
        assert TestClient(application(store, SMALL), client=(here, 1)).get("/metrics").status_code == 200


@pytest.mark.parametrize("text", ["ceramic mug", "mug ceramic", " MUG   cera", "mug"])
def test_each_word_of_a_search_is_found_in_any_order(client: TestClient, store: Store, text: str) -> None:
    """Of objects and of recordings, in the service and on pages; where one word is missing nothing is found."""
    mug = ThingRef("lab", "one", common_name="ceramic mug", maker="Ann & sons")
    store.put(squeeze(1, thing=mug, visibility="public"))
    store.put(squeeze(2, thing=ThingRef("lab", "two", common_name="wooden spoon"), visibility="public"))
    for kind in ("objects", "recordings"):
        assert len(client.get(f"{API}/{kind}", params={"text": text}).json()["items"]) == 1
        assert client.get(f"{API}/{kind}", params={"text": f"{text} spoon"}).json()["items"] == []
        page = client.get(f"/{kind}", params={"text": text}).text
        assert ("ceramic mug" in page, "wooden spoon" in page) == (True, False)
    assert len(client.get(f"{API}/objects", params={"text": "lab sons mug"}).json()["items"]) == 1
