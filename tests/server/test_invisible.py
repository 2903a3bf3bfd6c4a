"""What is private or under an embargo holds a word of its own in each field, and others find none of them anywhere."""

import itertools
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any

import pytest
from fastapi import FastAPI
from fastapi.routing import iter_route_contexts
from fastapi.testclient import TestClient

from palpate.server.names import thing_address
from palpate.server.security.accounts import Role
from palpate.store.entries import Distribution, Interval, Value
from palpate.store.keeping_episodes import put_episode
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from tests.store.made_up import made_episode, squeeze

KINDS = ("private", "embargoed")
SHARED = ThingRef("lab", "shared", common_name="a shared thing")
FIELDS: tuple[str, ...] = (
    "action",
    "dataset",
    "id",
    "maker",
    "common",
    "attribute",
    "alias",
    "gripper",
    "camera",
    "series",
    "channel",
)
FIELDS += ("file", "property", "label", "frame", "licence", "software", "repository", "grasp", "notice", "log", "step")
TOMORROW = datetime.now(UTC) + timedelta(days=1)
Token = Callable[..., dict[str, str]]


SAID = ("maker", "attribute", "alias")


def word(kind: str, field: str) -> str:
    return f"{kind}{field}zq"


def described(kind: str) -> ThingRef:
    """The object that all see, with words that only a recording that they do not see has for it."""
    words = {field: word(kind, f"shared{field}") for field in SAID}
    return replace(
        SHARED, maker=words["maker"], common_name=None, attributes={words["attribute"]: 1}, aliases=(words["alias"],)
    )


def hidden(kind: str, thing: ThingRef | None = None, number: int = 0) -> Recording:
    """A recording that no other sees, with a word of its own in each field."""
    words = {field: word(kind, field) for field in FIELDS}
    own = ThingRef(
        words["dataset"], words["id"], words["maker"], words["common"], {words["attribute"]: 1}, (words["alias"],)
    )
    tone = Channel(words["channel"], "sound pressure", None, squeeze().series[0].channels[0].values, rate_hz=8000.0)
    sharing: dict[str, Any] = {"visibility": "private"} if kind == "private" else {"visibility": "public"}
    return squeeze(
        KINDS.index(kind) + 10 * number,
        thing=thing or own,
        owner=None,
        action=words["action"],
        setup=Setup(
            gripper=Device("gripper", words["gripper"]), camera=Device("camera", "eye", parameters={words["camera"]: 1})
        ),
        series=(Series(words["series"], (tone,)),),
        files=(FileItem(f"{words['file']}.png", "image/png", b"\x89PNG\r\n\x1a\n" + words["file"].encode()),),
        entries=(
            Value(words["property"], 1.0, unit="g"),
            Value("mass", 4321.125, unit="g"),
            Interval("volume", 1.0, 2.0, "cm^3"),
            Distribution("material", {words["label"]: 1.0}),
        ),
        object_pose=Pose((0.0, 0.0, 0.0), None, words["frame"], {}),
        licence=words["licence"],
        software=words["software"],
        repository=words["repository"],
        grasp={words["grasp"]: 1},
        notices=(words["notice"],),
        log=words["log"],
        ground_truth=True,
        embargoed_until=TOMORROW if kind == "embargoed" else None,
        **sharing,
    )


SECOND = "second-sender"
"""Has sent the same as ann."""


@pytest.fixture
def secrets(store: Store) -> list[Recording]:
    """Hidden recordings of objects of their own and of one that all see, sent by ann, and explorations."""
    public = squeeze(90, thing=SHARED, visibility="public", entries=(Value("mass", 5.0, unit="g"),))
    store.put(public)
    made = [
        hidden("private"),
        hidden("private", described("private"), 1),
        hidden("embargoed", described("embargoed")),
        hidden("embargoed", None, 1),
    ]
    store.put_many(made, uploader="ann")
    store.put_many(made, uploader=SECOND)
    for place, one in enumerate(made):
        sharing: dict[str, Any] = {"visibility": one.visibility, "embargoed_until": one.embargoed_until}
        kind = KINDS[place // 2]
        own = made_episode(one, number=place, thing=one.thing, stop=word(kind, "step"), **sharing)
        put_episode(store, own, uploader="ann")
    # one that all see, with an action of which the recording is hidden
    told = made_episode(public, number=50, thing=SHARED, visibility="public")
    told = told.continued({"step": 2, "action": "weighing"}, made[0].digest).continued({"stop": "enough"})
    put_episode(store, told)
    return made


def markers(secrets: list[Recording]) -> set[str]:
    """All words, ids and digests that are hidden, and a number."""
    found = {word(kind, field) for kind, field in itertools.product(KINDS, FIELDS)} | {"4321.125", SECOND}
    found |= {word(kind, f"shared{field}") for kind in KINDS for field in SAID} - {word("embargoed", "sharedmaker")}
    for one in secrets:
        found |= {str(one.id), one.digest, one.setup.digest, one.files[0].sha256}
    return found


def addresses(app: FastAPI, secrets: list[Recording], ids: list[str]) -> Iterator[str]:
    """All that the application answers to, with what is hidden and what is not in the place of each name."""
    things = [thing_address(thing).split("/") for thing in {one.thing.id: one.thing for one in secrets}.values()]
    # one of an object of its own, and one of an object that all see
    some = (secrets[0], secrets[2])
    keys = [*(str(one.id) for one in some), secrets[3].digest]
    values = {"key": keys, "id": [*ids, keys[0]], "digest": [one.setup.digest for one in some]}
    for path in sorted(paths(app)):
        names = re.findall(r"{(\w+)(?::\w+)?}", path)
        pairs = things if {"dataset", "name"} <= set(names) else [["", ""]]
        others = [name for name in names if name not in ("dataset", "name")]
        for (dataset, name), *rest in itertools.product(pairs, *(values.get(one, ["0"]) for one in others)):
            filled = {"dataset": dataset, "name": name, **dict(zip(others, rest, strict=True))}
            yield re.sub(r"{(\w+)(?::\w+)?}", lambda found, filled=filled: filled[found[1]], path)  # type: ignore[misc]


def paths(app: FastAPI) -> set[str]:
    """Where anything can be read."""
    found = iter_route_contexts(app.routes)
    return {route.path for route in found if route.path is not None and "GET" in (route.methods or ())}


QUERIES = [
    *(f"/api/v1/{name}?text=zq" for name in ("objects", "recordings", "entries")),
    "/recordings?text=zq",
    "/objects?text=zq",
    "/api/v1/recordings?object=shared",
    "/api/v1/entries?property=mass",
    "/api/v1/entries?ground_truth=true",
    "/api/v1/recordings?sort=uploaded&order=ascending",
    "/compare?property=mass",
    "/compare/table.csv?property=mass",
    "/api/v1/objects?property=volume",
]


def episode_ids(client: TestClient, headers: dict[str, str]) -> list[str]:
    return [one["id"] for one in client.get("/api/v1/episodes", headers=headers).json()["items"]]


@pytest.mark.parametrize("person", ["anonymous", "curator"])
def test_nobody_else_finds_a_word_of_it(
    client: TestClient, secrets: list[Recording], token: Token, person: str
) -> None:
    """Each address that there is, asked for what is hidden and for what is not, tells none of the words."""
    ann = token("ann")
    headers = {} if person == "anonymous" else token(person, Role.parse(person))
    words, ids = markers(secrets), episode_ids(client, ann)
    assert len(ids) == 5
    mine = episode_ids(client, headers)
    asked = [*addresses(client.app, secrets, ids), *QUERIES]  # type: ignore[arg-type]
    assert len(asked) > 60
    for address in asked:
        found = client.get(address, headers=headers)
        # what is refused repeats what was asked for
        told = words - {one for one in words if one in address} if found.status_code >= 400 else words
        leaked = sorted(one for one in told if one in found.text or one in str(found.headers))
        assert not leaked, (person, address, found.status_code, leaked)
        assert not (any(id in address for id in set(ids) - set(mine)) and found.status_code < 400), address
    assert len(mine) == 1


def test_who_has_sent_it_finds_all_of_it(client: TestClient, secrets: list[Recording], token: Token) -> None:
    """The words are there for who may see them: what is not found above could have been found."""
    ann = token("ann")
    seen = ""
    for address in [*addresses(client.app, secrets, episode_ids(client, ann)), *QUERIES]:  # type: ignore[arg-type]
        found = client.get(address, headers=ann)
        seen += found.text + str(found.headers)
    assert {one for one in markers(secrets) if one not in seen} == {SECOND}


def test_a_refusal_tells_no_label_and_no_unit_of_it(client: TestClient, store: Store, token: Token) -> None:
    """What somebody mistypes is told by what they see: of a property that is measured in private only, nothing."""
    ann, bob = token("ann"), token("bob")
    secret = (Distribution("spoilage", {"secretlabel": 1.0}), Value("novelty", 1.0, unit="mol"))
    store.put(squeeze(1, thing=SHARED, owner="ann", entries=secret))
    store.put(squeeze(2, thing=ThingRef("lab", "his"), owner="bob", visibility="public"))

    def told(person: dict[str, str], thing: str, **entry: Any) -> Any:
        body = {"source": "x", "entry": {"kind": "value", "value": 1.0, **entry}}
        return client.put(f"/api/v1/objects/lab/{thing}/known", json=body, headers=person)

    assert "expected one of novelty, such as 'mol'" in told(ann, "shared", property="novelty").text
    assert "secretlabel" in told(ann, "shared", property="spoilage").text
    other = told(bob, "his", property="novelty", unit="g")
    assert "unit 'g' is mass; expected the dimension that novelty has in this store" in other.text
    for name in ("novelty", "spoilage"):
        assert told(bob, "his", property=name).status_code == 200
