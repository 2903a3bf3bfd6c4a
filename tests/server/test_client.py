"""The client against the service itself: what comes back is what was put, and a broken upload goes on."""

import http.client
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
import pytest

from palpate.client import Client, NotAllowedError, NotThereError, RefusedError, UnreachableError
from palpate.client.connection import Connection
from palpate.client.filters import FILTERS
from palpate.server.app import application
from palpate.server.settings import Settings
from palpate.store.entries import Value
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.records import Channel, Device, FileItem, Pose, Receipt, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from tests.server.serving import listening
from tests.server.test_explorations import explored
from tests.store.made_up import made_episode, squeeze

Token = Callable[..., dict[str, str]]


@pytest.fixture
def url(store: Store) -> Iterator[str]:
    """The address of a service; it takes 1 MiB at once."""
    with listening(application(store, Settings(largest_upload_bytes=1 << 20, requests_per_s=None))) as address:
        yield f"{address}/api/v1"


def secret(headers: dict[str, str]) -> str:
    return headers["Authorization"].removeprefix("Bearer ")


@pytest.fixture
def ann(url: str, token: Token) -> Client:
    """The client of an owner."""
    return Client(url, secret(token("ann")))


def many(count: int, **more: Any) -> list[Recording]:
    """Some recordings, each at a time of its own."""
    return [squeeze(n, owner="ann", **more) for n in range(count)]


def test_what_comes_back_is_what_was_put(ann: Client, store: Store) -> None:
    """By its id and by its digest, with arrays and files; also when its object was merged meanwhile."""
    wide = Channel("wide", "torque", "N*m", np.arange(12, dtype=np.float32).reshape(4, 3), time_s=np.arange(4.0))
    recording = squeeze(
        owner="ann", series=(Series("arm", (wide,)),), files=(FileItem("a.png", "image/png", b"\x89PNG..."),), log="hm"
    )
    receipt = ann.put(recording)
    for key in (recording.id, str(recording.id).upper(), recording.digest):
        found = ann.get(key)
        assert (found, found.digest) == (recording, recording.digest)
        assert found.files[0].data == b"\x89PNG..."
        np.testing.assert_array_equal(found.series[0].channels[0].values, wide.values)
    assert receipt.id == recording.id


def test_lists_follow_all_pages(ann: Client, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each row once, whatever is in a page; filters are the service's."""
    monkeypatch.setattr("palpate.client.client.ROWS", 3)
    recordings = many(8)
    store.put_many(recordings)
    ids = [str(one.id) for one in sorted(recordings, key=lambda one: one.recorded_at, reverse=True)]
    assert [row["id"] for row in ann.recordings()] == ids
    assert [row["id"] for row in ann.recordings(limit=5)] == ids[:5]
    assert list(ann.recordings(limit=0)) == []
    assert list(ann.recordings(ground_truth=True)) == []
    assert len(list(ann.entries(property=recordings[0].entries[0].property))) == 8
    until = min(one.recorded_at for one in recordings) + timedelta(microseconds=1)
    assert [row["id"] for row in ann.recordings(until=until)] == ids[-1:]
    (thing,) = ann.objects(text=recordings[0].thing.id)
    assert thing["recordings"] == sum(one.thing.id == recordings[0].thing.id for one in recordings)


def test_explorations(ann: Client, store: Store) -> None:
    """Listed, and each with its steps."""
    recording = squeeze(owner="ann")
    store.put(recording)
    episode = made_episode(recording, owner="ann", thing=recording.thing)
    put_episode(store, episode)
    (row,) = ann.episodes(object=recording.thing.id)
    assert row["id"] == str(episode.id)
    assert ann.episode(row["id"])["steps"]


def test_what_is_wrong_is_told(ann: Client, url: str, store: Store) -> None:
    """A filter that there is not, what is not there, what may not be seen, and a token that does not hold."""
    hidden = squeeze(owner="bob")
    store.put(hidden)
    with pytest.raises(RefusedError, match="colour"):
        ann.recordings(colour="red")
    with pytest.raises(NotThereError):
        ann.get(hidden.id)
    with pytest.raises(NotThereError):
        ann.episode("../users")
    with pytest.raises(NotAllowedError):
        Client(url, "palpate_wrong").get(hidden.id)
    with pytest.raises(NotAllowedError):
        next(Client(url, "").put_many(many(1)))


@pytest.mark.parametrize("store", ["sqlite"], indirect=True)
def test_the_client_knows_the_filters_of_the_service(store: Store) -> None:
    """All of each list, and no others; pages are turned by the client itself."""
    document = application(store, Settings()).openapi()
    for path, names in FILTERS.items():
        told = {one["name"] for one in document["paths"][f"/api/v1{path}"]["get"]["parameters"]}
        assert set(names) == told - {"limit", "cursor"}, path


@pytest.mark.parametrize("visibility", ["private", "lab", "public"])
@pytest.mark.parametrize("embargo", [None, timedelta(days=3)])
def test_what_somebody_else_has_sent_has_the_receipt_of_a_single_one(
    ann: Client, url: str, token: Token, visibility: str, embargo: timedelta | None
) -> None:
    """Sent among others or alone, by one who did not see it and by one who did: id and whether it is new agree."""
    until = None if embargo is None else datetime.now(UTC) + embargo
    others = [Client(url, secret(token(name))) for name in ("bob", "cat")]
    odd = (Value("mass", -5.0, None, "g"),)
    there = [squeeze(n, visibility=visibility, embargoed_until=until, entries=odd) for n in range(2)]
    kept = [ann.put(one) for one in there]
    new = squeeze(9, visibility=visibility)
    among = [became for _, became in others[0].put_many([there[0], new, there[1]])]
    alone = [others[1].put(there[0]), others[1].put(there[1])]
    assert [among[0], among[2]] == alone
    assert [one.id for one in alone] == [one.id for one in kept]
    again = [became for _, became in others[0].put_many(there)]
    assert again == [others[1].put(one) for one in there]
    assert all(isinstance(one, Receipt) and one.notices for one in again)


def test_many_are_kept_or_refused_each_by_itself(ann: Client, store: Store) -> None:
    """In their order; a large one goes by itself, and one that is larger than the server takes is refused alone."""
    good, large, too_large = many(3)
    wrong = replace(squeeze(7, owner="ann"), entries=(Value("elasticity", 1.0, None, "blorp"),))
    noise = np.random.default_rng(1).integers(0, 256, 5 << 20, dtype=np.uint8)
    zeros = Channel("load", "mass", "g", np.zeros(600_000), rate_hz=50.0)
    large = replace(large, series=(Series("arm", (zeros,)),))
    too_large = replace(too_large, files=(FileItem("noise", "application/octet-stream", noise.tobytes()),))
    sent = [good, wrong, large, too_large]
    told = list(ann.put_many(sent))
    assert [one for one, _ in told] == sent
    assert [isinstance(became, RefusedError) for _, became in told] == [False, True, False, True]
    assert "blorp" in str(told[1][1])
    assert store.known([one.digest for one in sent]) == {good.digest, large.digest}


NAN, INF = float("nan"), float("inf")
NOTHING = np.zeros(2)
FLAWED: dict[str, dict[str, Any]] = {
    "entries[0].value: found nan, expected a finite number": {"entries": (Value("elasticity", NAN, None, "kPa"),)},
    "entries[0].sd: found inf": {"entries": (Value("elasticity", 1.0, INF, "kPa"),)},
    "grasp": {"grasp": {"force_n": [1.0, -INF]}},
    "grasp.tags": {"grasp": {"tags": {"a"}}},
    "gripper_pose.translation_m": {"gripper_pose": Pose((0.0, NAN, 0.0), None, "base")},
    "setup.gripper.parameters": {"setup": Setup(gripper=Device("gripper", "hand", None, {"stroke_mm": NAN}))},
    "thing.attributes": {"thing": ThingRef("ycb", "mug", attributes={"height_mm": INF})},
    "thing.attributes.tags": {"thing": ThingRef("ycb", "mug", attributes={"tags": {"a"}})},
    "rate_hz": {"series": (Series("arm", (Channel("load", "mass", "g", NOTHING, rate_hz=NAN),)),)},
    "time_s": {"series": (Series("arm", (Channel("load", "mass", "g", NOTHING, None, np.array([0.0, NAN])),)),)},
    "there is no file": {"files": (FileItem("a.png", "image/png", Path("/nowhere/a.png")),)},
    "log": {"log": "\ud800"},
}


@pytest.mark.parametrize("store", ["sqlite"], indirect=True)
def test_what_json_cannot_hold_is_a_sentence(ann: Client, store: Store) -> None:
    """Which recording and which field, the same of one and of many; the others are kept, in their order."""
    flawed = [replace(squeeze(n, owner="ann"), **changes) for n, changes in enumerate(FLAWED.values())]
    good = squeeze(99, owner="ann")
    told = list(ann.put_many([*flawed[:5], good, *flawed[5:]]))
    assert isinstance(told.pop(5)[1], Receipt)
    for field, one, (sent, became) in zip(FLAWED, flawed, told, strict=True):
        assert sent is one
        with pytest.raises(RefusedError) as alone:
            ann.put(one)
        assert field in str(alone.value)
        assert str(became) == str(alone.value)
        assert str(became).startswith(f"recording {one.id}: ")
    gaps = Channel("load", "mass", "g", np.array([NAN, 1.0, INF]), rate_hz=50.0)
    for n, put in enumerate((ann.put, lambda one: next(ann.put_many([one]))[1])):
        whole = replace(squeeze(n, owner="ann"), series=(Series("arm", (gaps,)),))
        assert isinstance(put(whole), Receipt)
        np.testing.assert_array_equal(ann.get(whole.digest).series[0].channels[0].values, gaps.values)


def test_a_request_that_is_too_large_goes_in_parts(ann: Client, store: Store) -> None:
    """A server may take less at once than the client sends."""
    tones = [Channel("load", "mass", "g", np.full(30_000, float(n)), rate_hz=50.0) for n in range(8)]
    recordings = [replace(one, series=(Series("arm", (tone,)),)) for one, tone in zip(many(8), tones, strict=True)]
    assert all(not isinstance(became, RefusedError) for _, became in ann.put_many(recordings))
    assert len(store.known([one.digest for one in recordings])) == 8


def test_a_broken_upload_goes_on(ann: Client, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a break only what the server does not have is sent, and all are told about."""
    monkeypatch.setattr("palpate.client.batches.AT_ONCE", 4)
    recordings = many(10)
    posted = list[str]()
    ask = Connection.ask

    def counted(self: Connection, method: str, path: str, *rest: Any) -> Any:
        if path == "/recordings":
            posted.append(path)
            if len(posted) == 2:
                # the request arrives, and its answer is lost
                with ask(self, method, path, *rest) as answer:
                    answer.read()
                raise UnreachableError("the line is cut")
        return ask(self, method, path, *rest)

    monkeypatch.setattr(Connection, "ask", counted)
    told = list[Any]()
    with pytest.raises(UnreachableError, match="cut"):
        told.extend(ann.put_many(recordings))
    assert [one for one, _ in told] == recordings[:4]
    again = [became for _, became in ann.put_many(recordings)]
    assert [isinstance(one, Receipt) and one.new for one in again] == [False] * 8 + [True] * 2
    assert len(posted) == 3
    assert len(store.known([one.digest for one in recordings])) == 10


@pytest.mark.parametrize("size", [1_001, 0])
def test_how_many_may_be_asked_for(url: str, token: Token, size: int) -> None:
    """A thousand digests at once, and none."""
    connection = Connection(url, secret(token("ann")), 60.0)
    body = ('{"digests": [' + ",".join(['"' + "ab" * 32 + '"'] * size) + "]}").encode()
    headers = {"Content-Type": "application/json"}
    if size:
        with pytest.raises(RefusedError, match="digests"):
            connection.ask_plain("POST", "/recordings/known", body, headers)
    else:
        assert connection.ask_plain("POST", "/recordings/known", body, headers) == {"known": {}}


def test_only_uploads_may_be_large(url: str, token: Token) -> None:
    """A question is read into memory, and so is small for everybody."""
    address = url.removeprefix("http://").partition("/")[0]
    connection = http.client.HTTPConnection(address, timeout=30)
    connection.request("POST", "/api/v1/recordings/known", headers={"Content-Length": str(2 << 20)})
    assert connection.getresponse().status == 413
    connection.close()


def test_an_exploration_goes_on_where_it_stopped(ann: Client, store: Store) -> None:
    """Lines that the server has are not sent again; a line out of order, or another one, is refused."""
    episode = replace(explored(), id=uuid4())
    begun = replace(episode, steps=())
    assert ann.begin_episode(begun) == 0
    assert ann.put_line(episode.id, 1, episode.steps[0]) == 1
    assert ann.begin_episode(begun) == 1
    with pytest.raises(RefusedError, match="expected line 2"):
        ann.put_line(episode.id, 3, episode.steps[2])
    assert ann.put_episode(episode) == 2
    assert ann.put_episode(episode) == 0
    assert get_episode(store, episode.id).digest == episode.digest
    with pytest.raises(RefusedError, match="do not change"):
        ann.put_line(episode.id, 1, episode.steps[1])
    with pytest.raises(UnreachableError, match="expected the address of a service"):
        ann.put_line(uuid4(), 1, episode.steps[0])
