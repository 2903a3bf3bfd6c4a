"""Many recordings in one request: each is kept or refused by itself."""

import json
from collections.abc import Callable
from dataclasses import replace
from typing import Any
from uuid import uuid4

import pytest
from fastapi.testclient import TestClient
from hypothesis import given

from palpate.server.api import models
from palpate.server.security.accounts import Role
from palpate.store.checks import check
from palpate.store.entries import Value
from palpate.store.errors import StoreError
from palpate.store.importing.lines import line_of, recording_of
from palpate.store.records import Device, Pose, Recording, Setup
from palpate.store.store import Store
from tests.server.packages import package
from tests.store.made_up import recordings, squeeze

API = "/api/v1/recordings"
NDJSON = {"Content-Type": "application/x-ndjson"}
Token = Callable[..., dict[str, str]]


@given(recordings())
def test_a_line_holds_any_recording(recording: Recording) -> None:
    """What is read from a line is what was written, to the digest; only the order of bytes is always the same one."""
    found = recording_of(line_of(recording).encode())
    assert line_of(found) == line_of(recording)
    assert (found.id, found.digest) == (recording.id, recording.digest)


def with_values(values: Any, **more: Any) -> dict[str, Any]:
    """A series of one channel."""
    return {"series": [{"name": "a", "channels": [{"name": "b", "quantity": "c", "values": values, **more}]}]}


def test_lines_by_hand() -> None:
    """Numbers may be plain lists; what may be left out is what a recording has unless told."""
    line = {
        "recorded_at": "2024-05-01T12:00:00+00:00",
        "action": "squeezing",
        "thing": {"dataset": "ycb", "id": "025_mug"},
        "entries": [{"kind": "value", "property": "elasticity", "value": 5.0, "sd": None, "unit": "kPa"}],
        "setup": {"gripper": {"name": "jaws"}},
        "gripper_pose": {"translation_m": [0.0, 0.1, 0.2]},
        **with_values([1, None, 3], unit="N", rate_hz=10),
    }
    found = recording_of(json.dumps(line).encode())
    assert found.series[0].channels[0].values[2] == 3
    assert found.visibility == "private"
    assert found.gripper_pose == Pose((0.0, 0.1, 0.2))
    assert found.setup == Setup(gripper=Device("gripper", "jaws"))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"action": None}, "action"),
        ({"colour": "red"}, "colour"),
        ({"recorded_at": "yesterday"}, "recorded_at"),
        ({"entries": [{"kind": "guess"}]}, "entries"),
        ({"thing": "mug"}, "thing"),
        ({"log": 5}, "log"),
        ({"recorded_at": 5}, "^recorded_at: cannot be read, expected a time such as"),
        ({"entries": 5}, "^entries: is a int, expected a list"),
        ({"entries": [5]}, r"^entries\[0\]: is a int, expected an object with kind"),
        ({"entries": [{"kind": "value"}]}, r"^entries\[0\].property: is missing"),
        ({"entries": [{"kind": "value", "property": "a", "value": 1, "x": 2}]}, r"^entries\[0\]: 'x' is unknown"),
        ({"setup": 5}, "^setup: is a int, expected an object$"),
        ({"setup": {"hand": None}}, "^setup: 'hand' is unknown, expected arm, gripper"),
        ({"setup": {"gripper": {}}}, "^setup.gripper.name: is missing"),
        ({"setup": {"other": {}}}, "^setup.other: is a dict, expected a list"),
        ({"setup": {"other": [None]}}, r"^setup.other\[0\]: is a NoneType, expected an object"),
        ({"thing": {"id": "mug"}}, "^thing.dataset: is missing"),
        ({"thing": {"id": "mug", "dataset": "lab", "aliases": 3}}, "^thing: cannot be read, expected dataset"),
        ({"gripper_pose": {"translation_m": 5, "frame": "a"}}, "^gripper_pose: cannot be read, expected translation"),
        ({"series": {}}, "series"),
        ({"series": [{"name": "a"}]}, r"series\[0\].channels"),
        (with_values([[1], [1, 2]]), "values"),
        (with_values(["x"]), "values"),
        (
            with_values([1], rate_hz=True),
            "rate_hz",
        ),
        ({"files": [{"name": "a", "media_type": "b", "base64": "***"}]}, r"files\[0\].base64"),
        *(
            (with_values(values), "values")
            for values in (
                {"dtype": "O", "shape": [1], "base64": ""},
                {"dtype": "<f8", "shape": [10**12], "base64": ""},
                {"dtype": "<f8", "shape": [-1], "base64": ""},
                {"dtype": "<f8", "shape": [10**400], "base64": ""},
                {"dtype": ["<f8"], "shape": [1], "base64": ""},
                {"dtype": "<f8", "shape": [True], "base64": ""},
                {"dtype": "<f8", "shape": [1], "base64": 5},
            )
        ),
    ],
)
def test_lines_that_are_none(change: dict[str, Any], told: str) -> None:
    """The error names the field, whatever stands there."""
    plain = {**json.loads(line_of(squeeze())), **change}
    with pytest.raises(StoreError, match=told):
        check(recording_of(json.dumps(plain).encode()))


def test_each_line_is_told_about(client: TestClient, store: Store, token: Token) -> None:
    """New, known, refused and unreadable lines, in their order; the good ones are kept whatever the others are."""
    headers = {**token("ann"), **NDJSON}
    mine = [squeeze(number, owner="ann") for number in range(4)]
    store.put(mine[2])
    lines = [
        line_of(mine[0]),
        "{",
        line_of(squeeze(8, owner="bob")),
        "",
        line_of(mine[2]),
        line_of(mine[3]).replace('"kPa"', '"blorp"'),
        line_of(mine[1]),
        "[" * 100_000,
    ]
    answer = client.post(API, content="\n".join(lines), headers=headers)
    assert answer.status_code == 200
    items = models.Batch.model_validate(answer.json()).items
    assert [(one.source, one.status) for one in items] == [
        ("line 1", 201),
        ("line 2", 422),
        ("line 3", 422),
        ("line 5", 200),
        ("line 6", 422),
        ("line 7", 201),
        ("line 8", 422),
    ]
    assert items[0].id == mine[0].id
    assert items[3].id == mine[2].id
    assert items[2].errors[0].field == "owner"
    assert items[4].errors[0].field == "entries[0].unit"
    assert store.known([one.digest for one in mine]) == {mine[n].digest for n in (0, 1, 2)}
    again = client.post(API, content="\n".join(lines), headers=headers).json()["items"]
    assert [one["status"] for one in again] == [200, 422, 422, 200, 422, 200, 422]


HUGE = 10**400


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"entries": [{"kind": "value", "property": "elasticity", "value": HUGE, "unit": "kPa"}]}, "entries[0].value"),
        ({"entries": [{"kind": "distribution", "property": "m", "probabilities": {"a": HUGE}}]}, "entries[0]"),
        ({"gripper_pose": {"translation_m": [HUGE, 0, 0], "quaternion": None, "frame": "a", "original": None}}, "gri"),
        (with_values([1, 2], rate_hz=HUGE), "series[0]"),
    ],
)
def test_a_number_that_no_machine_holds_spoils_its_own_line_only(
    client: TestClient, store: Store, token: Token, change: dict[str, Any], told: str
) -> None:
    """A whole number of 400 digits is refused with its field, and the line beside it is kept."""
    good, plain = squeeze(1, owner="ann"), json.loads(line_of(squeeze(2, owner="ann")))
    body = f"{line_of(good)}\n{json.dumps({**plain, **change})}"
    answer = client.post(API, content=body, headers={**token("ann"), **NDJSON})
    assert [one["status"] for one in answer.json()["items"]] == [201, 422]
    assert answer.json()["items"][1]["detail"].startswith(told)
    assert store.known([good.digest])


def test_packages_in_a_form(client: TestClient, store: Store, token: Token) -> None:
    """Each package by itself, under its place and not under the name that somebody gave it."""
    mine = [squeeze(number, owner="ann") for number in range(2)]
    parts = [
        ("file", ("../../etc/passwd", package(mine[0]))),
        ("file", ("b.zip", b"PK")),
        ("other", ("b.zip", package(mine[1]))),
        ("file", ("c.zip", package(squeeze(9, owner="bob")))),
    ]
    items = client.post(API, files=parts, headers=token("ann")).json()["items"]
    assert [(one["source"], one["status"]) for one in items] == [
        ("package 1", 201),
        ("package 2", 422),
        ("package 3", 201),
        ("package 4", 422),
    ]
    assert "palpate-upload" not in json.dumps(items)
    assert store.known([one.digest for one in mine]) == {one.digest for one in mine}
    with_signals = store.get(mine[0].id)
    assert with_signals == mine[0]


def test_what_is_no_batch(client: TestClient, token: Token) -> None:
    """Another type, a form that is none, fields that are no files, too much, and nobody in particular."""
    headers = token("ann")
    assert client.post(API, content=b"{}", headers={**headers, "Content-Type": "application/json"}).status_code == 415
    broken = {**headers, "Content-Type": "multipart/form-data; boundary=x"}
    assert client.post(API, content=b"--y", headers=broken).status_code in (200, 400)
    assert client.post(API, content=b"x", headers={**headers, "Content-Type": "multipart/form-data"}).status_code == 400
    assert client.post(API, data={"a": "b"}, files={"c": b""}, headers=headers).status_code == 400
    assert client.post(API, content=b"\n" * ((1 << 20) + 1), headers={**headers, **NDJSON}).status_code == 413
    assert client.post(API, content=b"{}", headers=NDJSON).status_code == 401
    assert client.post(API, content=b"{}", headers={**token("r", Role.READER), **NDJSON}).status_code == 403
    many = client.post(API, content=b"1\n" * 10_002, headers={**headers, **NDJSON}).json()["items"]
    assert [one["status"] for one in many] == [422] * 10_001
    assert (many[-1]["source"], many[-1]["detail"]) == ("line 10001", "is one too many, expected 10000 at most")


def test_what_cannot_be_true_is_told(client: TestClient, token: Token) -> None:
    """A mass below nothing is kept with a notice, in the answer and on its page; as a truth it is refused."""
    measured = squeeze(owner="ann", entries=(Value("mass", -5.0, unit="g"),), ground_truth=False)
    body = "".join(line_of(one) + "\n" for one in (measured, replace(measured, id=uuid4(), ground_truth=True)))
    headers = token("ann")
    kept, refused = client.post(API, content=body, headers=NDJSON | headers).json()["items"]
    told = "entries[0].value: found -5, expected more than 0, as each mass is"
    assert (kept["status"], kept["notices"]) == (201, [told])
    assert (refused["status"], refused["detail"], refused["notices"]) == (422, told, [])
    again = client.put(f"{API}/{measured.digest}", content=package(measured), headers=headers)
    assert again.json()["notices"] == [told]
    assert told in client.get(f"/recordings/{measured.id}", headers=headers).text
