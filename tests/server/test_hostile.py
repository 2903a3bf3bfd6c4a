"""What is meant to break the server, to mislead it, or to learn from it what one may not see."""

import gzip
import io
import json
import struct
import time
from collections.abc import Callable
from statistics import median
from uuid import UUID, uuid4
from zipfile import ZipFile
from zlib import crc32

import numpy as np
import pytest
import zstandard
from fastapi.testclient import TestClient

from palpate.server import receiving
from palpate.server.api.downloads import LONGEST_NAME
from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.logging_in import set_password
from palpate.server.security.tokens import end, issue, revoke, tokens
from palpate.server.settings import Settings
from palpate.store.listing import list_recordings
from palpate.store.records import FileItem, Recording, ThingRef
from palpate.store.store import Store
from palpate.store.unpadded import from_unpadded
from tests.server.conftest import SMALL
from tests.server.packages import package, repacked
from tests.server.test_sessions import ORIGIN, PASSWORD, log_in
from tests.store.made_up import squeeze

API = "/api/v1"
Token = Callable[..., dict[str, str]]
MANY_DIGITS = "9" * 100_000
DEEP = "[" * 100_000 + "]" * 100_000


@pytest.mark.parametrize("value", [MANY_DIGITS, "1e400", "NaN", "-Infinity", DEEP, "9" * 400])
def test_numbers_and_nesting_that_nobody_can_hold(client: TestClient, store: Store, token: Token, value: str) -> None:
    """In any body of JSON they are an error of the sender, and nothing is changed."""
    store.put(squeeze(thing=ThingRef("lab", "cup"), visibility="public", owner="carl"))
    headers = {**token("carl", Role.CURATOR), "Content-Type": "application/json"}
    cup = f"{API}/objects/lab/cup"
    before = client.get(cup).json()
    entry = f'{{"entry": {{"kind": "value", "property": "mass", "value": {value}, "unit": "g"}}, "source": "me"}}'
    asked = [
        client.patch(cup, content=f'{{"attributes": {{"a": {value}}}, "maker": {value}}}', headers=headers),
        client.put(f"{cup}/known", content=entry, headers=headers),
        client.post(f"{API}/recordings/known", content=f'{{"digests": {value}}}', headers=headers),
    ]
    assert {one.status_code for one in asked} <= {400, 422}
    assert {one.headers["content-type"] for one in asked} == {"application/problem+json"}
    lines = {**headers, "Content-Type": "application/x-ndjson"}
    for line in (value, f'{{"recorded_at": {value}}}'):
        (became,) = client.post(f"{API}/recordings", content=line, headers=lines).json()["items"]
        assert became["status"] == 422
    assert client.get(cup).json() == before


def put(client: TestClient, headers: dict[str, str], digest: str, content: bytes, **more: str) -> int:
    return client.put(f"{API}/recordings/{digest}", content=content, headers={**headers, **more}).status_code


def test_bodies_are_not_unpacked_because_a_header_says_so(client: TestClient, store: Store, token: Token) -> None:
    """A compressed body is what it is: refused, and never a gigabyte in memory."""
    ann = token("ann")
    for packed, coding in ((gzip.compress(bytes(50 << 20)), "gzip"), (zstandard.compress(bytes(50 << 20)), "zstd")):
        assert put(client, ann, "a" * 64, packed, **{"Content-Encoding": coding}) == 422
    known = gzip.compress(json.dumps({"digests": []}).encode())
    asked = {**ann, "Content-Encoding": "gzip", "Content-Type": "application/json"}
    assert client.post(f"{API}/recordings/known", content=known, headers=asked).status_code == 400
    assert not list_recordings(store).rows


def npy_header(shape: str) -> bytes:
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}".encode()
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", len(head) + 1) + head + b"\n"


def bombs(recording: Recording) -> dict[str, bytes]:
    """Packages whose parts say that they hold more than anybody has."""
    names = zip_names(recording)
    series = next(name for name in names if name.startswith("series") or name.endswith((".npy", ".npz", ".arrow")))
    huge = [npy_header(shape) for shape in ("(10**12,)", "(1000000000000,)", "(4611686018427387904, 4)", "(-1,)")]
    found = {f"shape {place}": repacked(recording, {series: data}) for place, data in enumerate(huge)}
    found["zstd in a part"] = repacked(recording, {series: zstandard.compress(bytes(64 << 20))})
    return found


def zip_names(recording: Recording) -> list[str]:
    return ZipFile(io.BytesIO(package(recording))).namelist()


def test_parts_that_say_they_are_huge(client: TestClient, store: Store, token: Token) -> None:
    """They are refused for what is there, and not reserved memory for what is said."""
    recording = squeeze(owner="ann")
    ann = token("ann")
    for name, sent in bombs(recording).items():
        assert put(client, ann, recording.digest, sent) == 422, name
    assert not list_recordings(store).rows


def png_of(width: int, height: int) -> bytes:
    def chunk(kind: bytes, data: bytes) -> bytes:
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", crc32(kind + data))

    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", b"") + chunk(b"IEND", b"")


def test_what_says_too_much_is_not_read(
    client: TestClient, store: Store, token: Token, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A recording of very many results is refused before they are read, sent alone or with others."""
    sent = squeeze(owner="carl")
    headers = token("carl")
    monkeypatch.setattr(receiving, "LARGEST_JOURNAL_BYTES", 100)
    address = f"{API}/recordings/{sent.digest}"
    alone = client.put(address, content=package(sent), headers=headers)
    assert alone.status_code == 422
    assert "bytes when unpacked, expected 100 at most" in alone.json()["detail"]
    form = {"a": ("a.zip", package(sent))}
    (became,) = client.post(f"{API}/recordings", files=form, headers=headers).json()["items"]
    assert became["status"] == 422
    monkeypatch.undo()
    assert client.put(address, content=package(sent), headers=headers).status_code == 201


def test_a_picture_of_very_many_pixels_is_bytes(client: TestClient, store: Store) -> None:
    """The server does not unpack pictures: they go to the browser as they came."""
    data = png_of(100_000, 100_000)
    recording = squeeze(visibility="public", files=(FileItem("big.png", "image/png", data),))
    store.put(recording)
    assert client.get(f"/recordings/{recording.id}").status_code == 200
    assert client.get(f"{API}/recordings/{recording.id}/files/0").content == data


@pytest.mark.parametrize(
    ("name", "proposed"),
    [
        ('a"b\r\nX-Evil: 1.png', "a%22bX-Evil%3A%201.png"),
        ("photo\u202egnp.exe", "photognp.exe"),
        ("../../etc/passwd", "passwd"),
        ("..\\..\\a.png", "a.png"),
        ("..", "file"),
        (".bashrc", "bashrc"),
        ("a;b=c", "a%3Bb%3Dc"),
        ("日本.png", "%E6%97%A5%E6%9C%AC.png"),
        ("\x7f\u2028", "file"),
        ("x" * 5000 + ".png", "x" * (LONGEST_NAME - 3) + ".png"),
    ],
)
def test_proposed_names_of_files(client: TestClient, store: Store, name: str, proposed: str) -> None:
    """One part of a path, without what is not printed, as RFC 6266 writes it."""
    recording = squeeze(visibility="public", files=(FileItem(name, "text/plain", b"x"),))
    store.put(recording)
    found = client.get(f"{API}/recordings/{recording.id}/files/0")
    assert found.headers["content-disposition"] == f"attachment; filename*=UTF-8''{proposed}"
    assert "x-evil" not in found.headers


def test_what_is_hidden_answers_as_what_is_not_there(client: TestClient, store: Store, token: Token) -> None:
    """By id and by digest, to nobody and to others: the same answer, the same headers, in about the same time."""
    secret = squeeze(owner="ann")
    store.put(secret)
    missing = (str(uuid4()), "b" * 64)
    for headers in ({}, token("bob"), token("carl", Role.CURATOR)):
        for root in (f"{API}/recordings", "/recordings"):
            for hidden, none in zip((str(secret.id), secret.digest), missing, strict=True):
                first = client.get(f"{root}/{hidden}", headers=headers)
                second = client.get(f"{root}/{none}", headers=headers)
                assert (first.status_code, second.status_code) == (404, 404)
                assert first.text.replace(hidden, "") == second.text.replace(none, "")
                assert dict(first.headers) == dict(second.headers)
    times: dict[str, list[float]] = {str(secret.id): [], missing[0]: []}
    for _ in range(15):
        for key, taken in times.items():
            began = time.perf_counter()
            client.get(f"{API}/recordings/{key}")
            taken.append(time.perf_counter() - began)
    hidden_s, none_s = (median(taken) for taken in times.values())
    assert 1 / 3 < hidden_s / none_s < 3


def test_the_same_content_of_somebody_else(client: TestClient, store: Store, token: Token) -> None:
    """Who sends what is somebody else's is refused as if it were not there, and learns no id of it."""
    secret = squeeze(owner="ann")
    other = squeeze(1, owner="ann")
    store.put(secret)
    bob = token("bob")
    for recording in (secret, other):
        found = client.put(f"{API}/recordings/{recording.digest}", content=package(recording), headers=bob)
        assert found.status_code == 422
        assert found.json()["errors"][0]["field"] == "owner"
        assert str(secret.id) not in found.text
        batch = client.post(f"{API}/recordings", files={"a": ("a.zip", package(recording))}, headers=bob).json()
        assert [one["status"] for one in batch["items"]] == [422]
    known = client.post(f"{API}/recordings/known", json={"digests": [secret.digest]}, headers=bob).json()
    assert known == {"known": {}}


def test_ids_have_their_forms_and_no_others(client: TestClient, store: Store) -> None:
    """What Python would take for one, with spaces or fewer digits, is none."""
    recording = squeeze(visibility="public")
    store.put(recording)
    digest = recording.digest
    for key in (f"{digest[:62]}  ", f" {recording.id}", f"{recording.id}%0a", digest[:63], f"{digest}0", "\u0661" * 64):
        assert client.get(f"{API}/recordings/{key}").status_code == 404, key
        assert client.get(f"/recordings/{key}").status_code == 404, key


FORMS = ["/login", "/logout", "/example", "/objects/lab/cup/edit"]


@pytest.mark.parametrize("address", FORMS)
@pytest.mark.parametrize(
    "origin", [None, "null", "http://evil.example", "http://testserver.evil.example", "testserver"]
)
def test_no_form_of_another_site_does_anything(
    client: TestClient, store: Store, address: str, origin: str | None
) -> None:
    """Whoever's cookie it brings: each form says from where it was sent."""
    store.put(squeeze(thing=ThingRef("lab", "cup"), visibility="public"))
    add_user(store, "ann", Role.ADMIN)
    set_password(store, "ann", PASSWORD)
    assert log_in(client) == 303
    fields = {"name": "ann", "password": PASSWORD, "do": "describe", "maker": "evil"}
    headers = {} if origin is None else {"Origin": origin}
    assert client.post(address, data=fields, headers=headers, follow_redirects=False).status_code == 403
    assert client.get(f"{API}/objects/lab/cup").json()["maker"] is None
    assert "Log out" in client.get("/").text


@pytest.mark.parametrize("how", ["log out", "revoke"])
def test_a_session_is_over_at_once(client: TestClient, store: Store, how: str) -> None:
    """Logged out elsewhere, or revoked by an administrator: the cookie is nobody's."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    store.put(squeeze(owner="ann"))
    assert log_in(client) == 303
    assert client.get(f"{API}/recordings").json()["items"]
    if how == "log out":
        end(store, client.cookies["palpate-session"])
    else:
        revoke(store, tokens(store, "ann")[-1].id)
    assert client.get(f"{API}/recordings").json()["items"] == []


def test_a_new_password_ends_all_sessions(client: TestClient, store: Store) -> None:
    """Whoever had the old one has nothing any more; tokens of programs hold."""
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    store.put(squeeze(owner="ann"))
    program = {"Authorization": f"Bearer {issue(store, 'ann')}"}
    assert log_in(client) == 303
    set_password(store, "ann", "another horse battery")
    assert client.get(f"{API}/recordings").json()["items"] == []
    assert client.get(f"{API}/recordings", headers=program).json()["items"]


@pytest.mark.parametrize(
    "header", ["X-Forwarded-Host", "X-Forwarded-For", "X-Forwarded-Proto", "Forwarded", "X-Original-URL"]
)
def test_headers_of_proxies_change_no_address(client: TestClient, header: str) -> None:
    """What anybody can send is in no link and opens nothing."""
    store_free = client.get("/guides/upload", headers={header: "127.0.0.1, evil.example"})
    assert "evil.example" not in store_free.text
    assert client.get("/metrics", headers={header: "127.0.0.1"}).status_code == 401


@pytest.mark.parametrize(
    "address", ["//evil.example", "/%2f%2fevil.example/", "/\\evil.example/", "/objects/", "/login?next=//evil.example"]
)
def test_no_redirect_leads_elsewhere(client: TestClient, store: Store, address: str) -> None:
    """Neither by a path, nor after logging in."""
    found = client.get(f"http://testserver{address}", follow_redirects=False)
    assert found.headers.get("location", "http://testserver/").startswith("http://testserver/")
    add_user(store, "ann", Role.OWNER)
    set_password(store, "ann", PASSWORD)
    sent = client.post(
        "/login?next=//evil.example",
        data={"name": "ann", "password": PASSWORD, "next": "//evil.example"},
        headers=ORIGIN,
        follow_redirects=False,
    )
    assert (sent.status_code, sent.headers["location"]) == (303, "/")


def test_other_sites_may_not_read(client: TestClient) -> None:
    """No answer tells a browser that another site may have it, and methods that nobody needs are none."""
    asks = {"Origin": "http://evil.example", "Access-Control-Request-Method": "PUT"}
    for method in ("GET", "HEAD", "OPTIONS", "TRACE", "PROPFIND", "FOO"):
        found = client.request(method, f"{API}/recordings", headers=asks)
        assert found.status_code == (200 if method in ("GET", "HEAD") else 405)
        assert not [name for name in found.headers if name.startswith("access-control")]
        if found.status_code == 405:
            assert found.headers["allow"] == "GET, HEAD, POST"


def test_answers_are_not_kept_for_others(client: TestClient, store: Store, token: Token) -> None:
    """What one person may see no cache shows to another one."""
    recording = squeeze(owner="ann", files=(FileItem("a.png", "image/png", b"\x89PNG\r\n\x1a\n"),))
    store.put(recording)
    ann = token("ann")
    one = f"{API}/recordings/{recording.id}"
    for address in (f"{API}/recordings", one, f"{one}/files/0", f"{one}/package", f"/recordings/{recording.id}", "/"):
        found = client.get(address, headers=ann)
        assert found.status_code == 200
        assert {"private", "no-cache"} <= set(found.headers["cache-control"].split(", ")) | {"no-store"}
        assert {"Authorization", "Cookie"} <= set(found.headers["vary"].split(", "))
    etag = client.get(f"{one}/files/0", headers=ann).headers["etag"]
    assert client.get(f"{one}/files/0", headers={"If-None-Match": etag}).status_code == 404


RANGES = [
    "bytes=" + ",".join(["0-1"] * 2000),
    "bytes=0-,0-,0-",
    "bytes=9999999999999999999999-",
    "bytes=-9999999999999999999999",
    "bytes=5-2",
    "bytes=\u0661-\u0662",
    "bytes=0x1-0x2",
    "bytes= 0 - 1",
    "items=0-1",
]


@pytest.mark.parametrize("asked", RANGES)
def test_odd_ranges_give_no_more_than_the_file(client: TestClient, store: Store, asked: str) -> None:
    """Many, overlapping, backwards or endless: an error, one part, or the whole, once."""
    data = bytes(range(200))
    recording = squeeze(visibility="public", files=(FileItem("a.bin", "application/octet-stream", data),))
    store.put(recording)
    found = client.get(f"{API}/recordings/{recording.id}/files/0", headers={b"Range": asked.encode()})
    assert found.status_code in (200, 206, 416)
    assert found.status_code == 416 or found.content in data


def test_cursors_that_are_tampered_with(client: TestClient, store: Store, token: Token) -> None:
    """A cursor is a place in a list and no right: changed, or of another list or person, it shows nothing more."""
    ann = token("ann")
    store.put_many([squeeze(number, owner="ann") for number in range(3)])
    store.put_many([squeeze(number, visibility="public") for number in range(10, 13)])
    cursor = client.get(f"{API}/recordings?limit=1", headers=ann).json()["next"]
    seen = client.get(f"{API}/recordings", params={"cursor": cursor, "limit": 50}).json()["items"]
    assert {one["visibility"] for one in seen} <= {"public"}
    for resource in ("objects", "episodes", "recordings?sort=action", "recordings?order=descending"):
        address = f"{API}/{resource}{'&' if '?' in resource else '?'}cursor={cursor}"
        found = client.get(address)
        assert found.status_code == (200 if resource.endswith("descending") else 422), found.text
    rng = np.random.default_rng(3)
    for _ in range(60):
        letters = list(cursor)
        letters[rng.integers(len(letters))] = chr(rng.integers(33, 127))
        found = client.get(f"{API}/recordings", params={"cursor": "".join(letters)})
        assert found.status_code in (200, 422)
        assert "private" not in found.text


def test_cursors_do_not_count_what_is_hidden(client: TestClient, store: Store, token: Token) -> None:
    """They name the last row by its id, and are the same whatever others keep meanwhile; row numbers are none."""
    ann, admin = token("ann"), token("boss", Role.ADMIN)
    store.put_many([squeeze(number, visibility="public") for number in range(4)])
    lists = [f"{API}/recordings?limit=2&sort={sort}" for sort in ("recorded", "uploaded", "action")]
    before = [client.get(one).json() for one in lists]
    store.put_many([squeeze(number, owner="ann") for number in range(20, 27)])
    assert [client.get(one).json() for one in lists] == before
    for address, page in zip(lists, before, strict=True):
        assert json.loads(from_unpadded(page["next"]))[2:] == [UUID(page["items"][-1]["id"]).hex]
        rest = client.get(f"{address}&cursor={page['next']}").json()["items"]
        assert len({item["id"] for item in (*page["items"], *rest)}) == 4
    for reader, address in ((admin, lists[1]), (ann, lists[0])):
        foreign = client.get(address, headers=reader).json()["next"]
        assert client.get(f"{address}&cursor={foreign}", headers=reader).status_code == 200
        refused = client.get(f"{address}&cursor={foreign}")
        assert (refused.status_code, refused.json()["detail"].partition(":")[0]) == (422, "cursor")


def test_wildcards_are_letters(client: TestClient, store: Store) -> None:
    """Per cent and underscore find themselves, and a search of them takes no longer than another."""
    for number, name in enumerate(("50% wool", "50x wool", "a_b", "axb", "back\\slash")):
        store.put(squeeze(number, thing=ThingRef("lab", name), visibility="public"))
    for text, found in (("50%", {"50% wool"}), ("a_b", {"a_b"}), ("\\", {"back\\slash"}), ("%_%", set())):
        for resource, field in (("objects", "name"), ("recordings", "object")):
            items = client.get(f"{API}/{resource}", params={"text": text}).json()["items"]
            names = {one[field] if field == "name" else one[field]["name"] for one in items}
            assert names == found, (resource, text)
    store.put(squeeze(9, thing=ThingRef("lab", "a" * 200), visibility="public"))
    began = time.perf_counter()
    assert client.get(f"{API}/objects", params={"text": "%a" * 250}).json()["items"] == []
    assert time.perf_counter() - began < 5


def test_a_source_that_is_mistyped_forgets_nothing(client: TestClient, store: Store, token: Token) -> None:
    """A parameter that there is not is an error, and does not mean all sources."""
    store.put(squeeze(thing=ThingRef("lab", "cup"), visibility="public"))
    carl = token("carl", Role.CURATOR)
    entry = {"kind": "value", "property": "mass", "value": 1.0, "unit": "g"}
    cup = f"{API}/objects/lab/cup"
    client.put(f"{cup}/known", json={"entry": entry, "source": "a"}, headers=carl)
    assert client.delete(f"{cup}/known?property=mass&sorce=b", headers=carl).status_code == 422
    assert len(client.get(cup).json()["known"]) == 1


def test_health_and_errors_say_nothing_of_the_place(store: Store, tmp_path: object) -> None:
    """No path, no address of a database, no version of a library."""
    with TestClient(application(store, SMALL), raise_server_exceptions=False) as client:
        for address in ("/health", "/nothing", f"{API}/recordings/nothing", f"{API}/recordings?limit=x"):
            found = client.get(address)
            for word in ("sqlite", "postgresql", str(tmp_path), "Traceback", "uvicorn", "starlette"):
                assert word not in found.text
            assert "server" not in found.headers


def test_a_server_with_names_makes_no_link_by_another(store: Store) -> None:
    """Where it has names of its own, a header `Host` that is another one is refused before anything else."""
    settings = Settings(hosts=("measurements.example.org",), requests_per_s=None)
    with TestClient(application(store, settings), base_url="https://measurements.example.org") as client:
        for host in ("evil.example", "measurements.example.org.evil.example", "measurements.example.org@evil.example"):
            found = client.get(f"{API}/recordings?limit=1", headers={"Host": host, "X-Forwarded-Host": host})
            assert (found.status_code, "evil" in str(found.headers)) == (421, False)
