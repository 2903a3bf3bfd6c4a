"""Uploads: kept once, by those who may, and only what a store would keep."""

import io
import struct
import zipfile
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient

from palpate.server.security.accounts import Role
from palpate.store.entries import Value
from palpate.store.records import Recording
from palpate.store.store import Store
from tests.server.packages import package, repacked
from tests.store.made_up import squeeze

API = "/api/v1/recordings"
Headers = dict[str, str]
Token = Callable[..., Headers]


def send(client: TestClient, recording: Recording, headers: Headers, body: bytes | None = None) -> Any:
    return client.put(f"{API}/{recording.digest}", content=body or package(recording), headers=headers)


def test_a_recording_is_kept_once(client: TestClient, store: Store, token: Token) -> None:
    """The first time it is new, the second time known, under the same id; it is what was sent."""
    recording, headers = squeeze(owner="ann"), token("ann")
    first, second = (send(client, recording, headers) for _ in range(2))
    assert (first.status_code, second.status_code) == (201, 200)
    assert first.json() == {"id": str(recording.id), "digest": recording.digest, "new": True, "notices": []}
    assert second.json() == {**first.json(), "new": False}
    assert store.get(recording.id) == recording
    assert first.headers["location"] == f"{API}/{recording.id}"


def test_another_digest_is_refused(client: TestClient, store: Store, token: Token) -> None:
    """What is sent under the digest of another recording is not kept."""
    refused = client.put(f"{API}/{'ab' * 32}", content=package(squeeze(owner="ann")), headers=token("ann"))
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "digest"
    assert not store.known([squeeze(owner="ann").digest])


@pytest.mark.parametrize(
    ("owner", "visibility", "status"),
    [
        ("ann", "private", 201),
        (None, "public", 201),
        (None, "private", 201),
        ("bob", "public", 422),
    ],
)
def test_nobody_uploads_in_the_name_of_others(
    client: TestClient, token: Token, owner: str | None, visibility: str, status: int
) -> None:
    """One's own, or what states no owner; who has sent it sees it, and others do where they may."""
    recording, headers = squeeze(owner=owner, visibility=visibility), token("ann")
    assert send(client, recording, headers).status_code == status
    seen = client.get(f"{API}/{recording.id}", headers=headers), client.get(f"{API}/{recording.id}")
    assert [one.status_code == 200 for one in seen] == [status == 201, status == 201 and visibility == "public"]
    # an administrator moves whole data sets
    assert send(client, recording, token("root", Role.ADMIN)).status_code in (200, 201)


def test_a_wrong_field_is_named(client: TestClient, store: Store, token: Token) -> None:
    """What the store would not keep is refused with the field and the reason, and no word of where that was found."""
    recording = replace(squeeze(owner="ann"), entries=(Value("elasticity", 1.0, None, "blorp"),))
    refused = send(client, recording, token("ann"))
    assert refused.status_code == 422
    assert refused.json()["errors"][0]["field"] == "entries[0].unit"
    assert "blorp" in refused.json()["detail"]
    assert not store.known([recording.digest])


def _without_end(data: bytes) -> bytes:
    return data[:-40]


def _many_parts(_: bytes) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        for number in range(10_001):
            archive.writestr(f"{number}", b"")
    return made.getvalue()


def _states_few_parts(data: bytes) -> bytes:
    """The same many, with an end that states one."""
    many = _many_parts(data)
    at = many.rfind(b"PK\x05\x06")
    return many[: at + 8] + struct.pack("<HH", 1, 1) + many[at + 12 :]


def _bomb(_: bytes) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("journal.jsonl", b"\0" * (64 << 20))
    return made.getvalue()


def _lying_bomb(data: bytes) -> bytes:
    """A bomb that states to be small."""
    made = bytearray(_bomb(data))
    at = made.rfind(b"PK\x01\x02")
    made[at + 24 : at + 28] = struct.pack("<I", 100)
    made[22:26] = struct.pack("<I", 100)
    return bytes(made)


def _traversal(_: bytes) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w") as archive:
        archive.writestr("../../../../tmp/palpate-was-here", b"!")
    return made.getvalue()


def _deep(data: bytes) -> bytes:
    made = io.BytesIO()
    with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("journal.jsonl", b"[" * 200_000 + b"\n")
    return made.getvalue()


@pytest.mark.parametrize(
    "spoil",
    [
        lambda _: b"",
        lambda _: b"PK\x05\x06",
        lambda _: b"<html>",
        _without_end,
        _many_parts,
        _states_few_parts,
        _bomb,
        _lying_bomb,
        _traversal,
        _deep,
    ],
)
def test_packages_that_are_none(
    client: TestClient, store: Store, token: Token, spoil: Callable[[bytes], bytes]
) -> None:
    """Whatever is sent, the answer is one sentence that says no, and nothing is kept."""
    recording = squeeze(owner="ann")
    refused = client.put(f"{API}/{recording.digest}", content=spoil(package(recording)), headers=token("ann"))
    assert refused.status_code == 422
    assert "palpate-upload" not in refused.text
    assert not store.known([recording.digest])


def test_an_array_that_states_to_be_huge(client: TestClient, store: Store, token: Token) -> None:
    """The header of an array is not believed."""
    recording = squeeze(owner="ann")
    with zipfile.ZipFile(io.BytesIO(package(recording))) as archive:
        name = next(name for name in archive.namelist() if name.endswith(".npy"))
        data = archive.read(name)
    for shape in ((10**13,), (10**30,), (-1,), (2**31, 2**31)):
        header = io.BytesIO()
        np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": shape})
        spoilt = repacked(recording, {name: header.getvalue() + data[-80:]})
        assert send(client, recording, token(f"ann{len(str(shape))}{shape[0] % 7}"), spoilt).status_code == 422
    assert not store.known([recording.digest])


def test_pickles_are_not_loaded(client: TestClient, token: Token) -> None:
    """An array of objects would run whatever it was told to."""
    recording = squeeze(owner="ann")
    with zipfile.ZipFile(io.BytesIO(package(recording))) as archive:
        name = next(name for name in archive.namelist() if name.endswith(".npy"))
    evil = io.BytesIO()
    np.save(evil, np.array([print], dtype=object), allow_pickle=True)
    assert send(client, recording, token("ann"), repacked(recording, {name: evil.getvalue()})).status_code == 422


def test_bodies_are_limited(client: TestClient, token: Token) -> None:
    """A body that is too large is refused, whether it says so or not."""
    headers = token("ann")
    large = b"x" * ((1 << 20) + 1)
    assert client.put(f"{API}/{'ab' * 32}", content=large, headers=headers).status_code == 413

    def pieces() -> Any:
        for start in range(0, len(large), 1 << 16):
            yield large[start : start + (1 << 16)]

    assert client.put(f"{API}/{'ab' * 32}", content=pieces(), headers=headers).status_code == 413


@pytest.mark.parametrize(
    ("headers", "status"),
    [
        ({}, 401),
        ({"Authorization": "Bearer palpate_wrong"}, 401),
        ({"Authorization": "Bearer"}, 401),
        ({"Authorization": "Basic YW5uOmFubg=="}, 401),
        ({"Authorization": "Bearer \xff\xfe"}, 401),
    ],
)
def test_a_token_is_needed(client: TestClient, store: Store, headers: Headers, status: int) -> None:
    """Without one that holds nothing is kept, and nothing is read."""
    recording = squeeze()
    encoded = {name: value.encode("latin-1") for name, value in headers.items()}
    refused = client.put(f"{API}/{recording.digest}", content=package(recording), headers=encoded)  # type: ignore[arg-type]
    assert refused.status_code == status
    assert refused.headers["www-authenticate"].startswith("Bearer")
    assert not store.known([recording.digest])


def test_a_reader_does_not_write(client: TestClient, token: Token) -> None:
    """A token for reading is known, and not enough."""
    assert send(client, squeeze(owner="ann"), token("ann", Role.READER)).status_code == 403
