"""Every end point, asked by everybody: what somebody may not see is nowhere, and looks like what is not there."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import pytest
from fastapi.testclient import TestClient

from palpate.server.names import thing_address
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.store.describing import change_thing, keep_image
from palpate.store.entries import Distribution, Value
from palpate.store.keeping_episodes import put_episode
from palpate.store.merging import merge_things
from palpate.store.records import Channel, Device, FileItem, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer
from palpate.store.visible_setups import seen_devices
from tests.server.conftest import KEY
from tests.server.test_corrections import OPERATIONS
from tests.server.test_sharing import OPERATIONS as SHARING
from tests.store.made_up import made_episode, squeeze

API = "/api/v1"
SHARED = ("/recordings/{key}", "/episodes/{id}")
VISIBILITIES = ("private", "lab", "public")
PEOPLE = ("anonymous", "reader", "ann", "curator", "admin", "host")
SEEN = {
    "anonymous": {"public"},
    "reader": {"public", "lab"},
    "ann": {"public", "lab", "private"},
    "curator": {"public", "lab"},
    "admin": {"public", "lab", "private"},
    "host": {"public", "lab", "private"},
}
ROLES = {"reader": Role.READER, "ann": Role.OWNER, "curator": Role.CURATOR, "admin": Role.ADMIN}
PNG = b"\x89PNG\r\n\x1a\n"


@dataclass
class World:
    """A store in which all that belongs to a recording has the recording's visibility in its name."""

    store: Store
    recordings: dict[str, Recording]
    episodes: dict[str, Any]
    setups: dict[str, str]
    devices: dict[str, str]
    headers: dict[str, dict[str, str]]

    def addresses(self, visibility: str) -> Iterator[str]:
        """All that is about one recording, its object, its setup and its exploration."""
        recording = self.recordings[visibility]
        for key in (recording.id, recording.digest):
            one = f"{API}/recordings/{key}"
            yield from (one, f"{one}/files", f"{one}/files/0", f"{one}/log", f"{one}/series", f"{one}/series/0")
            yield f"{one}/package"
            yield f"{one}/series/0/channels/0/sound"
            yield f"/recordings/{key}"
            yield f"/recordings/{key}/series/0/channels/0/spectrogram.png"
            yield f"/recordings/{key}/series/0/channels/0/plot.json"
        thing = thing_address(recording.thing)
        yield from (f"{API}/objects/{thing}", f"{API}/objects/{thing}/images/0", f"/objects/{thing}")
        yield f"/objects/{thing}/plot.json?property=mass"
        yield f"/compare/curves.json?recording={recording.id}"
        device = self.devices[visibility]
        yield from (f"/devices/{device}", f"/devices/{device}/errors.json?property=mass")
        yield from (f"{API}/setups/{recording.setup.digest}", f"/setups/{recording.setup.digest}")
        yield from (f"{API}/episodes/{self.episodes[visibility].id}", f"/episodes/{self.episodes[visibility].id}")


LISTS = [
    *(f"{API}/{name}" for name in ("objects", "recordings", "entries", "devices", "setups", "properties", "episodes")),
    *(f"{API}/{name}?text=marker" for name in ("objects", "recordings", "entries")),
    *(f"{API}/{name}?object=marker-shared" for name in ("recordings", "entries", "episodes")),
    "/",
    "/objects",
    "/recordings",
    "/devices",
    "/compare?property=mass",
    "/compare?property=mass&object=lab/marker-shared",
    "/compare/plot.json?property=mass",
    "/benchmark",
    "/benchmark/errors.csv",
    "/benchmark/errors.json",
    "/compare/table.csv?property=mass",
    "/episodes",
    "/objects/lab/marker-shared",
]


def made(visibility: str) -> Recording:
    marker = f"marker-{visibility}"
    tone = Channel("sound", "sound pressure", None, squeeze().series[0].channels[0].values, rate_hz=8000.0)
    return squeeze(
        VISIBILITIES.index(visibility),
        visibility=visibility,
        owner="ann",
        thing=ThingRef("lab", marker, common_name=f"{marker} thing"),
        setup=Setup(gripper=Device("gripper", f"{marker}-gripper")),
        series=(Series(f"{marker}-series", (tone,)),),
        files=(FileItem(f"{marker}.png", "image/png", PNG + marker.encode()),),
        entries=(Value("mass", 5.0, 1.0, "g"), Value(f"{marker}-property", 1.0, None, "g")),
        notices=(f"{marker} notice",),
        log=f"{marker} log",
    )


@pytest.fixture
def world(store: Store) -> World:
    recordings = {name: made(name) for name in VISIBILITIES}
    store.put_many(recordings.values())
    shared = squeeze(9, visibility="public", thing=ThingRef("lab", "marker-shared"))
    store.put(shared)
    episodes = {}
    for name, recording in recordings.items():
        episode = made_episode(recording, visibility=name, owner="ann", thing=recording.thing)
        put_episode(store, episode)
        episodes[name] = episode
        image = keep_image(store, f"marker-{name}.png", "image/png", PNG)
        change_thing(store, recording.thing, lambda thing, image=image: thing.showing(image), who="ann")  # type: ignore[misc]
        # an object that all see, and of which each sees the parts that they may
        merge_things(store, recording.thing, shared.thing, who="ann")
    change_thing(store, shared.thing, lambda thing: thing.knowing(Value("mass", 4.0, unit="g"), "a scale"))
    headers = {"anonymous": {}, "host": {"Cookie": f'palpate-key="{KEY}"', "Origin": "http://testserver"}}
    for name, role in ROLES.items():
        add_user(store, name, role)
        headers[name] = {"Authorization": f"Bearer {issue(store, name)}"}
    setups = {name: one.setup.digest for name, one in recordings.items()}
    grippers = {one.device.name: one.digest for one in seen_devices(store, Viewer(everything=True))}
    devices = {name: grippers[f"marker-{name}-gripper"] for name in VISIBILITIES}
    return World(store, recordings, episodes, setups, devices, headers)


@pytest.mark.parametrize("person", PEOPLE)
def test_what_may_not_be_seen_is_not_there(client: TestClient, world: World, person: str) -> None:
    """Each address of a recording, its parts, object, setup and exploration: there, or as if it were not."""
    for visibility in VISIBILITIES:
        for address in world.addresses(visibility):
            found = client.get(address, headers=world.headers[person])
            expected = 200 if visibility in SEEN[person] else 404
            if expected == 200 and address.startswith("/episodes"):
                expected = 422  # the made-up exploration has no belief to show
            assert found.status_code == expected, (person, address, found.text[:300])
            if expected == 404:
                assert f"marker-{visibility}" not in re.sub(r"object lab/\S+:", "", found.text)


@pytest.mark.parametrize("person", PEOPLE)
def test_lists_and_searches_hold_only_what_may_be_seen(client: TestClient, world: World, person: str) -> None:
    """No list, search, count or page holds a word of what somebody may not see, and all hold what they may."""
    for address in LISTS:
        found = client.get(address, headers=world.headers[person])
        assert found.status_code == 200, (address, found.text[:300])
        for visibility in VISIBILITIES:
            if visibility not in SEEN[person]:
                assert f"marker-{visibility}" not in found.text, (person, address)
    for name in ("recordings", "episodes", "devices", "setups"):
        count = len(client.get(f"{API}/{name}", headers=world.headers[person]).json()["items"])
        assert count == len(SEEN[person]) + (name != "episodes")
    shared = client.get(f"{API}/objects/lab/marker-shared", headers=world.headers[person]).json()
    assert {one["name"] for one in shared["merged"]} == {f"marker-{name}" for name in SEEN[person]}
    assert shared["recordings"] == len(SEEN[person]) + 1
    (mass,) = (
        one
        for one in client.get(f"{API}/properties", headers=world.headers[person]).json()["items"]
        if one["name"] == "mass"
    )
    assert mass["entries"] == len(SEEN[person])


@pytest.mark.parametrize("person", PEOPLE)
def test_who_has_accounts_and_tokens(client: TestClient, world: World, person: str) -> None:
    """Administrators see all accounts, everybody their own tokens, and nobody ends those of others."""
    headers = world.headers[person]
    is_admin = person in ("admin", "host")
    expected = 401 if person == "anonymous" else 200
    of_all = 401 if person == "anonymous" else 200 if is_admin else 403
    assert client.get(f"{API}/users", headers=headers).status_code == of_all
    listed = client.get(f"{API}/tokens", headers=headers)
    assert listed.status_code == expected
    if expected == 200:
        users = {one["user"] for one in listed.json()["items"]}
        assert users == (set(ROLES) if is_admin else {person})
        assert "palpate_" not in listed.text
    of_reader = client.get(f"{API}/tokens", headers=world.headers["reader"]).json()["items"][0]["id"]
    ended = client.delete(f"{API}/tokens/{of_reader}", headers=headers).status_code
    assert ended == (401 if person == "anonymous" else 204 if is_admin or person == "reader" else 404)
    still = client.get(f"{API}/recordings", headers=world.headers["reader"]).status_code
    assert still == (401 if ended == 204 else 200)


def test_a_lesser_token_ends_no_greater_one(client: TestClient, world: World) -> None:
    """Who has found a token for reading cannot lock out the administrator that it is of; it ends itself."""
    world.headers["found"] = {"Authorization": f"Bearer {issue(world.store, 'admin', Role.READER)}"}
    held = {
        one["role"]: one["id"] for one in client.get(f"{API}/tokens", headers=world.headers["found"]).json()["items"]
    }
    assert client.delete(f"{API}/tokens/{held['admin']}", headers=world.headers["found"]).status_code == 404
    assert client.get(f"{API}/users", headers=world.headers["admin"]).status_code == 200
    assert client.delete(f"{API}/tokens/{held['reader']}", headers=world.headers["found"]).status_code == 204
    assert client.get(f"{API}/tokens", headers=world.headers["found"]).status_code == 401


@pytest.mark.parametrize("person", PEOPLE)
def test_only_what_one_sees_is_known(client: TestClient, world: World, person: str) -> None:
    """Who asks by digest what need not be sent is told of nothing that they may not see."""
    by_digest = {one.digest: name for name, one in world.recordings.items()}
    asked = {"digests": [*by_digest, "ab" * 32]}
    found = client.post(f"{API}/recordings/known", json=asked, headers=world.headers[person])
    assert found.status_code == {"anonymous": 401, "reader": 403}.get(person, 200)
    if found.status_code == 200:
        assert {by_digest[digest] for digest in found.json()["known"]} == SEEN[person]


@pytest.mark.parametrize("person", PEOPLE)
def test_who_goes_on_with_an_exploration(client: TestClient, world: World, person: str) -> None:
    """Whose it is, and administrators; to whom may not see it, it is not there, whatever they send."""
    theirs = ("ann", "admin", "host")
    for visibility, episode in world.episodes.items():
        line = {"record": {"stop": f"enough for {person}"}}
        found = client.put(f"{API}/episodes/{episode.id}/lines/2", json=line, headers=world.headers[person])
        seen = 403 if visibility in SEEN[person] else 404
        # the made-up exploration has no belief to show
        expected = {"anonymous": 401, "reader": 403}.get(person, 422 if person in theirs else seen)
        assert found.status_code == expected, (person, visibility, found.text)
        start = {"started_at": "2024-05-01T00:00:00Z", "thing": {"dataset": "a", "id": "b"}, "header": {}}
        begun = client.put(f"{API}/episodes/{episode.id}", json=start, headers=world.headers[person])
        assert begun.status_code == {"anonymous": 401, "reader": 403}.get(person, 422)


def test_what_is_known_in_private_does_not_show_in_a_filter(client: TestClient, world: World) -> None:
    """A filter by what an object is known to be goes by what the asker may know."""
    secret = squeeze(
        20,
        visibility="private",
        owner="ann",
        ground_truth=True,
        thing=ThingRef("lab", "marker-shared"),
        entries=(Distribution("material", {"wood": 1.0}),),
    )
    world.store.put(secret)
    for address in (
        f"{API}/recordings?known=material:wood",
        f"{API}/recordings?material=wood",
        f"{API}/objects?known=material:wood",
    ):
        assert client.get(address).json()["items"] == []
        assert client.get(address, headers=world.headers["ann"]).json()["items"]


def test_beliefs_and_overlays_hold_only_what_may_be_seen(client: TestClient, store: Store) -> None:
    """Of explorations of one object, and of recordings asked for together, those that one sees, and no trace else."""
    cup, ids = ThingRef("lab", "cup"), []
    for number, visibility in enumerate(("public", "private")):
        gripper = Device("gripper", f"marker-{visibility}")
        one = squeeze(number, visibility=visibility, owner="ann", thing=cup, setup=Setup(gripper=gripper))
        ids.append(store.put(one).id)
        step = {"step": 1, "action": "weighing", "belief": {f"marker-{visibility}": {"probabilities": {"foam": 1.0}}}}
        put_episode(store, made_episode(number=number, visibility=visibility, owner="ann", thing=cup).continued(step))
    add_user(store, "ann", Role.OWNER)
    ann = {"Authorization": f"Bearer {issue(store, 'ann')}"}
    both = "&".join(f"recording={one}" for one in ids)
    for headers, sees_all in (({}, False), (ann, True)):
        page = client.get("/objects/lab/cup", headers=headers).text
        assert "Marker-public, as believed" in page
        assert ("marker-private" in page.lower()) == sees_all
        for address in ("/objects/lab/cup/beliefs.json?property=marker-private", f"/recordings/{ids[1]}"):
            assert client.get(address, headers=headers).status_code == (200 if sees_all else 404)
        curves = client.get(f"/compare/curves.json?{both}", headers=headers).text
        assert "marker-public" in curves
        assert ("marker-private" in curves) == sees_all


def test_no_address_was_forgotten(client: TestClient, world: World) -> None:
    """Each operation of the service is asked above, or tested to need more."""
    document = client.get(f"{API}/openapi.json").json()
    patterns = [
        re.compile(re.sub(r"\\{\w+\\}", "[^/]+", re.escape(path)) + r"(\?.*)?")
        for path, methods in document["paths"].items()
        if "get" in methods
    ]
    asked = [
        *world.addresses("public"),
        *LISTS,
        f"{API}/users",
        f"{API}/tokens",
        "/health",
        "/metrics",
        f"{API}/objects/a/b/history",
        f"{API}/recordings/a/history",
        f"{API}/episodes/a/history",
    ]
    assert not [pattern.pattern for pattern in patterns if not any(pattern.fullmatch(one) for one in asked)]
    others = {
        (method, path) for path, methods in document["paths"].items() for method in methods if method not in ("get",)
    }
    thing = f"{API}/objects/{{dataset}}/{{name}}"
    corrections = {(method.lower(), f"{thing}{path.partition('?')[0]}") for method, path, _ in OPERATIONS}
    assert others == {
        ("put", f"{API}/recordings/{{key}}"),
        ("post", f"{API}/recordings"),
        ("post", f"{API}/recordings/known"),
        ("put", f"{API}/episodes/{{id}}"),
        ("put", f"{API}/episodes/{{id}}/lines/{{position}}"),
        ("post", f"{API}/tokens"),
        ("delete", f"{API}/tokens/{{id}}"),
        *(one for one in corrections if one[0] != "get"),
        *((method.lower(), f"{API}{of}{path}") for of in SHARED for method, path, _ in SHARING if method != "GET"),
    }


@pytest.mark.parametrize("person", PEOPLE)
def test_who_uploads_by_a_form(client: TestClient, world: World, person: str) -> None:
    """Pages and forms for accounts that may write; what waits is nobody else's; `/rest/` takes no such token."""
    headers, expected = world.headers[person], {"anonymous": 401, "reader": 403}.get(person)
    assert client.get("/upload", headers=headers).status_code == (expected or 200)
    assert client.post("/upload", headers=headers).status_code == (expected or 422)
    form = {**headers, "Origin": "http://testserver"}
    assert client.post("/upload/one", data={"value": "1"}, headers=form).status_code == (expected or 422)
    shown = [("GET", f"/recordings/{'0' * 64}/{one}") for one in ("files/0", "series/0/channels/0/sound")]
    for method, address in (("GET", ""), ("GET", "/kept"), ("POST", "/keep"), ("POST", "/cancel"), *shown):
        found = client.request(method, f"/upload/{'x' * 43}{address}", headers=form)
        assert found.status_code == (expected or 404)
    for name in ("measurements", "entries", "grasp_proposals"):
        # in the clear, from another computer
        assert client.post(f"/rest/{name}/", headers=headers).status_code == 403
        over_tls = client.post(f"https://testserver/rest/{name}/", headers=headers)
        assert over_tls.status_code == 401


def test_a_token_ends(client: TestClient, store: Store, world: World) -> None:
    """An expired token is refused, also where none is needed; a lesser one does less than its account may."""
    expired = issue(store, "ann", days=1e-9)
    assert client.get(f"{API}/recordings", headers={"Authorization": f"Bearer {expired}"}).status_code == 401
    lesser = {"Authorization": f"Bearer {issue(store, 'admin', Role.READER)}"}
    assert client.get(f"{API}/users", headers=lesser).status_code == 403
    assert {one["visibility"] for one in client.get(f"{API}/recordings", headers=lesser).json()["items"]} == {
        "public",
        "lab",
    }
