"""The old program's addresses, asked as its published uploader asks them; the requests are written by hand."""

import json
import time
from base64 import b64encode
from collections.abc import Iterator, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import urlencode
from uuid import UUID

import anyio
import pytest
from fastapi.testclient import TestClient

from palpate.server.app import application
from palpate.server.rest import forms
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.logging_in import set_password
from palpate.server.security.tokens import issue
from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.opening import open_store
from palpate.store.records import Recording
from palpate.store.store import Store
from tests.server.conftest import KEY, SMALL

PASSWORD = "correct horse battery"
PNG = b"\x89PNG\r\n\x1a\n picture"
EDGE = "1d9bdc6e4cd0e5a8"
BANANA = {"common_name": "banana_ycb", "dataset_id": "011_banana", "dataset": "ycb"}
SETUP = {"gripper": "robotiq_2f85", "arm": "kinova_gen3", "camera": "intel d435", "algorithm": "https://example.org/a"}


def basic(name: str, secret: str) -> dict[str, str]:
    return {"Authorization": "Basic " + b64encode(f"{name}:{secret}".encode()).decode()}


def form(field: str, plain: Any, files: Mapping[str, tuple[str, bytes]]) -> tuple[bytes, dict[str, str]]:
    """The bytes of the uploader's request: a field of JSON, and files named by where they belong."""
    parts = [f'--{EDGE}\r\nContent-Disposition: form-data; name="{field}"\r\n\r\n{json.dumps(plain)}\r\n'.encode()]
    for key, (name, data) in files.items():
        head = f'--{EDGE}\r\nContent-Disposition: form-data; name="{key}"; filename="{name}"\r\n\r\n'
        parts.append(head.encode() + data + b"\r\n")
    return b"".join(parts) + f"--{EDGE}--\r\n".encode(), {"Content-Type": f"multipart/form-data; boundary={EDGE}"}


def measurement(**changes: Any) -> dict[str, Any]:
    found = {
        "object_instance": BANANA,
        "setup": SETUP,
        "sensor_outputs": {
            "robotiq_2f85": {"current": [0.0, 0.08, 0.1], "position": [0.87, 62.0, 62.4], "time": [0.0, 1.0, 2.0]},
            "intel d435": {"image": "/home/robot/exp_0/img_cam1.png", "params": {"exposure_ms": 8}},
        },
        "grasp": None,
        "object_pose": {"rotation": [173.3, 15.5, -21.0], "translation": [0.465, -0.013, 0.081]},
        "gripper_pose": {"rotation": [-180.0, 0.0, 0.0], "grasped": True, "translation": [0.4, -0.005, 0.16]},
    }
    return {**found, **changes}


def elasticity(**changes: Any) -> dict[str, Any]:
    value = {"std": 4.5, "mean": 31.0, "units": "kPa", "name": "elasticity", **changes}
    return {"values": [value], "type": "continuous", "name": "elasticity", "repository": "https://example.org/code"}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    """A new store in a file: what is put into it is put into others by the same code."""
    with open_store(tmp_path / "store.sqlite", tmp_path / "blobs", durable=False) as found:
        yield found


@pytest.fixture
def here(store: Store) -> Iterator[TestClient]:
    """The application asked from this computer, by an account whose token stands in the password's place."""
    with TestClient(application(store, SMALL), client=("127.0.0.1", 50_000), raise_server_exceptions=False) as found:
        found.headers.update(_of_jeff(store))
        yield found


def _of_jeff(store: Store) -> dict[str, str]:
    # a token is looked up at once, and a password takes a tenth of a second
    add_user(store, "jeff", Role.OWNER)
    return basic("jeff", issue(store, "jeff"))


def send(
    client: TestClient,
    plain: Any,
    files: Mapping[str, tuple[str, bytes]] | None = None,
    path: str = "/rest/measurements/",
    field: str = "measurement",
    headers: Mapping[str, str] | None = None,
) -> Any:
    body, kind = form(field, plain, files or {})
    return client.post(path, content=body, headers={**kind, **(headers or {})})


def stored(store: Store, found: Any) -> Recording:
    return store.get(UUID(found.json()["id"]))


def test_a_measurement_with_files_becomes_a_recording(here: TestClient, store: Store) -> None:
    """Signals, devices, poses, result and files are where they belong, and the answer says what was odd."""
    files = {
        "measurement intel d435 image": ("img_cam1.png", PNG),
        "measurement png": ("front.png", PNG),
        "entry values elasticity": ("fit.png", PNG),
    }
    found = send(here, {"measurement": measurement(), "entry": elasticity()}, files)
    assert found.status_code == 201, found.text
    recording = stored(store, found)
    assert (recording.action, recording.owner, recording.visibility) == ("squeezing", "jeff", "private")
    assert (recording.thing.dataset, recording.thing.id) == ("ycb", "011_banana")
    assert recording.entries == (Value("elasticity", 31.0, 4.5, "kPa"),)
    assert recording.setup.camera is not None
    assert recording.setup.camera.parameters == {"exposure_ms": 8}
    (series,) = recording.series
    assert {channel.name: channel.values.tolist() for channel in series.channels}["position"] == [0.87, 62.0, 62.4]
    kept = {item.name: item.data for item in recording.files}
    assert [kept[name] for name in ("intel d435/image.png", "picture.png", "entry/elasticity.png")] == [PNG] * 3
    assert recording.object_pose is not None
    assert recording.object_pose.translation_m == (0.465, -0.013, 0.081)
    odd = found.json()["odd"]
    assert tuple(odd) == recording.notices
    assert any("states no time" in one for one in odd)
    assert any("it is private" in one for one in odd)


def test_without_files_the_form_is_url_encoded(here: TestClient, store: Store) -> None:
    """As the library of the uploader sends it; several entries, and a mean that is NaN, are taken."""
    plain = {
        "measurement": measurement(sensor_outputs={}, object_pose=None, gripper_pose=None),
        "entry": elasticity(mean=float("nan"), units=None),
        "entries": [
            {
                "name": "mat-vision",
                "type": "categorical",
                "repository": None,
                "values": [{"name": "wood", "probability": 0.25}, {"name": "plastic", "probability": 0.75}],
            },
            {
                "name": "size",
                "type": "size",
                "repository": None,
                "values": [{"name": "x", "value": 85, "std": 5, "units": "mm"}],
            },
        ],
    }
    body = urlencode({"measurement": json.dumps(plain)})
    kind = {"Content-Type": "application/x-www-form-urlencoded"}
    found = here.post("/rest/measurements/", content=body, headers=kind)
    assert found.status_code == 201, found.text
    entries = stored(store, found).entries
    assert entries[0] == Distribution("material", {"wood": 0.25, "plastic": 0.75})
    assert entries[1] == Value("x", 85.0, 5.0, "mm")
    assert isinstance(entries[2], FailedEntry)
    assert any("failed measurement" in one for one in found.json()["odd"])


def test_sent_again_it_is_known(here: TestClient, store: Store) -> None:
    """A script that begins anew makes no second recording, though the form has no time."""
    plain = {"measurement": measurement(), "entry": elasticity()}
    first, second = send(here, plain), send(here, plain)
    assert (first.status_code, second.status_code) == (201, 200)
    assert first.json()["id"] == second.json()["id"]
    other = send(here, {"measurement": measurement(), "entry": elasticity(mean=32.0)})
    assert other.status_code == 201
    assert other.json()["id"] != first.json()["id"]


def test_an_entry_is_added_to_a_measurement(here: TestClient, store: Store) -> None:
    """It is a recording of its own, of the same object, devices and time; of none that one may not see."""
    first = send(here, {"measurement": measurement(), "entry": elasticity()})
    value = {"name": "mass", "value": 66, "std": 2, "units": "g"}
    entry = {"type": "other", "measurement_id": first.json()["id"], "repository": "", "values": [value]}
    added = send(here, {"entry": entry}, path="/rest/entries/", field="entry")
    assert added.status_code == 201, added.text
    old, new = stored(store, first), stored(store, added)
    assert new.entries == (Value("mass", 66.0, 2.0, "g"),)
    assert (new.thing.id, new.setup, new.recorded_at, new.action) == (
        old.thing.id,
        old.setup,
        old.recorded_at,
        old.action,
    )
    assert any(str(old.id) in one for one in new.notices)
    for wrong in (1, "nonsense", None, "00000000-0000-0000-0000-000000000000"):
        refused = send(here, {"entry": {**entry, "measurement_id": wrong}}, path="/rest/entries/", field="entry")
        assert refused.status_code == 400
        assert refused.text.startswith("entry.measurement_id: found")
    add_user(store, "kim", Role.OWNER)
    body, kind = form("entry", {"entry": entry}, {})
    of_other = here.post("/rest/entries/", content=body, headers={**basic("kim", issue(store, "kim")), **kind})
    assert of_other.status_code == 400


def test_a_grasp_proposal_is_kept_and_shown(here: TestClient, store: Store) -> None:
    """As the old program's columns or as lists; it is on the page of its object, and is no result of anything."""
    columns = {"tx": 0.1, "ty": 0.0, "tz": 0.2, "rx": 0.0, "ry": 1.5, "rz": 0.0}
    more = {"number_of_fingers": 2, "gripper": "robotiq_2f85", "source": "by hand", "parameters": {"width_mm": 40}}
    plain = {"grasp_proposal": {"object_instance": BANANA, **columns, **more}}
    found = send(here, plain, path="/rest/grasp_proposals/", field="grasp_proposal")
    assert found.status_code == 201, found.text
    recording = stored(store, found)
    assert recording.entries == ()
    assert recording.grasp == {
        "proposed": True,
        "translation": [0.1, 0.0, 0.2],
        "rotation": [0.0, 1.5, 0.0],
        **more,
    }
    key = {"Cookie": f'palpate-key="{KEY}"', "Authorization": ""}
    page = here.get("/objects/ycb/011_banana", headers=key).text
    assert "Grasps that were proposed" in page
    assert "by hand" in page
    assert "translation 0.1, 0.0, 0.2" in here.get(f"/recordings/{recording.id}", headers=key).text
    wrong = {"grasp_proposal": {"object_instance": BANANA, **columns, "tz": "high"}}
    refused = send(here, wrong, path="/rest/grasp_proposals/", field="grasp_proposal")
    assert (refused.status_code, refused.text[:28]) == (400, "grasp_proposal.translation: ")


WRONG = {
    "no measurement": {"entry": elasticity()},
    "no object": {"measurement": measurement(object_instance=0)},
    "no setup": {"measurement": {k: v for k, v in measurement().items() if k != "setup"}},
    "a unit that is none": {"measurement": measurement(), "entry": elasticity(units="blorp")},
    "a pose of two": {"measurement": measurement(object_pose={"translation": [1, 2], "rotation": [0, 0, 0]})},
    "a list of entries that is none": {"measurement": measurement(), "entries": {"name": "size"}},
    "an entry that is none": {"measurement": measurement(), "entry": [1]},
    "samples in samples": {"measurement": measurement(sensor_outputs={"arm": {"torque": [[1], [2]]}})},
    "nested": json.loads("[" * 200 + "]" * 200),
    "deep attributes": {
        "measurement": measurement(object_instance={**BANANA, "other": json.loads("[" * 300 + "]" * 300)})
    },
}


def test_a_refusal_is_a_sentence_and_no_json(here: TestClient) -> None:
    """The published uploader notes each answer that is JSON as a success, and never sends that measurement again."""
    for case, plain in WRONG.items():
        found = send(here, plain)
        assert found.status_code == 400, (case, found.text)
        assert found.headers["content-type"].startswith("text/plain")
        assert len(found.text.strip().splitlines()) == 1
        assert "/tmp" not in found.text
        with pytest.raises(json.JSONDecodeError):
            json.loads(found.text)


def test_every_refusal_is_no_json(here: TestClient, store: Store) -> None:
    """Also where there is no account, no such address, no form, no JSON, or too much."""
    body, kind = form("measurement", {"measurement": measurement()}, {})
    answers = [
        here.post("/rest/measurements/", content=body, headers={**kind, "Authorization": ""}),
        here.post("/rest/measurements/", content=body, headers={**kind, **basic("jeff", "wrong password")}),
        here.post("/rest/measurements/", content=body, headers={**kind, **basic("nobody", PASSWORD)}),
        here.post("/rest/measurements/", content=b"{}"),
        here.post("/rest/measurements/", content=b"x" * (2 << 20), headers=kind),
        here.post("/rest/nowhere/", content=body, headers=kind),
        here.get("/rest/measurements/"),
        send(here, {}, field="picture"),
    ]
    assert [one.status_code for one in answers] == [401, 401, 401, 415, 413, 404, 405, 400]
    for one in answers:
        assert one.headers["content-type"].startswith("text/plain"), one.text
        with pytest.raises(json.JSONDecodeError):
            json.loads(one.text)
    assert "Basic" in answers[0].headers["www-authenticate"]


def test_names_of_files_lead_nowhere(here: TestClient, store: Store) -> None:
    """Neither the name of a file nor a path in the JSON reads or writes elsewhere."""
    outputs = {"camera": {"image": "/etc/passwd", "depth": "../../../../etc/passwd"}}
    files = {"measurement camera depth": ("../../evil.png", PNG), "../../../x": ("..\\..\\y.html", b"<script>")}
    found = send(here, {"measurement": measurement(sensor_outputs=outputs)}, files)
    assert found.status_code == 201, found.text
    kept = {item.name: item.data for item in stored(store, found).files}
    assert kept["camera/depth.png"] == PNG
    assert not any(b"root:" in bytes(data) for data in kept.values() if isinstance(data, bytes))
    bearer = {"Authorization": f"Bearer {issue(store, 'jeff')}"}
    page = here.get(f"/api/v1/recordings/{found.json()['id']}/files/1", headers=bearer)
    assert page.headers["content-type"] == "application/octet-stream"


def test_a_password_in_the_clear_is_refused(client: TestClient, store: Store) -> None:
    """From another computer only TLS will do; nothing is kept, and the sentence says what to do."""
    headers = _of_jeff(store)
    refused = send(client, {"measurement": measurement()}, headers=headers)
    assert refused.status_code == 403
    assert "https://" in refused.text
    with TestClient(application(store, SMALL), base_url="https://testserver") as tls:
        assert send(tls, {"measurement": measurement()}, headers=headers).status_code == 201


def test_a_token_may_stand_in_the_passwords_place(here: TestClient, store: Store) -> None:
    """That of the account that is named, and of a role that may upload."""
    add_user(store, "rita", Role.READER)
    here.headers.pop("Authorization")
    tokens = {"jeff": issue(store, "jeff"), "rita": issue(store, "rita")}
    body, kind = form("measurement", {"measurement": measurement()}, {})
    pairs = {("jeff", "jeff"): 201, ("rita", "rita"): 403, ("rita", "jeff"): 401, ("jeff", "rita"): 401}
    for (name, of), status in pairs.items():
        found = here.post("/rest/measurements/", content=body, headers={**kind, **basic(name, tokens[of])})
        assert found.status_code == status, (name, of)


def test_a_page_elsewhere_sends_no_form_with_a_browsers_password(here: TestClient) -> None:
    """Browsers that know a name and a password send them along whoever has written the page."""
    plain = {"measurement": measurement()}
    assert send(here, plain, headers={"Origin": "http://evil.example"}).status_code == 403
    assert send(here, plain, headers={"Origin": "http://testserver"}).status_code == 201


def test_wrong_passwords_are_counted_and_right_ones_are_not(here: TestClient, store: Store) -> None:
    """An upload of many logs in for each; who guesses is stopped as at the log-in, also with the right one then."""
    set_password(store, "jeff", PASSWORD)
    body, kind = form("measurement", {"measurement": measurement()}, {})
    right, wrong = ({**kind, **basic("jeff", secret)} for secret in (PASSWORD, "wrong password"))
    assert {here.post("/rest/measurements/", content=body, headers=right).status_code for _ in range(3)} == {200, 201}
    found = [here.post("/rest/measurements/", content=body, headers=wrong).status_code for _ in range(11)]
    assert found == [401] * 10 + [429]
    assert here.post("/rest/measurements/", content=body, headers=right).status_code == 429


def test_guesses_at_once_are_no_more_than_one_by_one(
    here: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each is counted before its password is looked at, which takes long."""
    set_password(store, "jeff", PASSWORD)
    body, kind = form("measurement", {"measurement": measurement()}, {})
    looked = list[str]()

    def slowly(password: str, kept: str | None) -> bool:
        looked.append(password)
        time.sleep(0.3)
        return False

    monkeypatch.setattr("palpate.server.security.basic.is_password", slowly)

    def guess(number: int) -> int:
        headers = {**kind, **basic("jeff", f"guess {number}")}
        return int(here.post("/rest/measurements/", content=body, headers=headers).status_code)

    with ThreadPoolExecutor(12) as pool:
        assert sorted(pool.map(guess, range(12))) == [401] * 10 + [429] * 2
    assert len(looked) == 10


def test_fields_have_an_end_and_files_a_larger_one(here: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """JSON is read whole into memory, all fields together; a refusal is a sentence."""
    monkeypatch.setattr(forms, "LARGEST_FIELDS_BYTES", 4000)
    plain = {"measurement": measurement()}
    large = {"measurement png": ("front.png", PNG + bytes(100_000))}
    assert send(here, plain, large).status_code == 201
    one = form("measurement", {**plain, "note": "x" * 4000}, {})
    several = (_fields(10, 410) + one[0], one[1])
    encoded = urlencode({"measurement": json.dumps(plain), "note": "x" * 4000}).encode()
    for body, kind in (one, several, (encoded, {"Content-Type": "application/x-www-form-urlencoded"})):
        refused = here.post("/rest/measurements/", content=body, headers=kind)
        assert refused.status_code == 413, refused.text
        assert refused.text == "the fields of the form are too large, expected 4000 bytes at most beside its files\n"


def _fields(count: int, size: int) -> bytes:
    head = f'--{EDGE}\r\nContent-Disposition: form-data; name="n{{}}"\r\n\r\n{"y" * size}\r\n'
    return "".join(head.format(number) for number in range(count)).encode()


@pytest.mark.parametrize("path", ["/rest/measurements/", "/api/v1/recordings", "/login"])
def test_who_goes_away_in_the_middle_is_no_error_of_the_server(
    here: TestClient, store: Store, caplog: pytest.LogCaptureFixture, path: str
) -> None:
    """Networks of robots break; the log is for what somebody should look at."""
    body, kind = form("measurement", {"measurement": measurement()}, {"measurement png": ("a.png", PNG)})
    if path == "/login":
        kind = {"Content-Type": "application/x-www-form-urlencoded", "Origin": "http://testserver"}
    elif path != "/rest/measurements/":
        # that takes files only
        body = body[body.index(f"--{EDGE}".encode(), 1) :]
        kind["authorization"] = f"Bearer {issue(store, 'jeff')}"
    headers = {**dict(here.headers), **kind, "host": "testserver"}
    scope = {"type": "http", "method": "POST", "path": path, "raw_path": path.encode(), "query_string": b""}
    scope |= {"headers": [(name.lower().encode(), value.encode()) for name, value in headers.items()]}
    scope |= {"scheme": "http", "client": ("127.0.0.1", 1), "server": ("testserver", 80), "root_path": ""}
    coming = iter(({"type": "http.request", "body": body[:150], "more_body": True}, {"type": "http.disconnect"}))
    sent = list[Any]()

    async def receive() -> Any:
        return next(coming)

    async def keep(message: Any) -> None:
        sent.append(message)

    anyio.run(here.app, scope | {"http_version": "1.1"}, receive, keep)
    assert sent[0]["status"] == 400
    assert b"the body ended early" in sent[1]["body"]
    assert [one.getMessage() for one in caplog.records if one.levelname == "ERROR"] == []


def test_behind_a_proxy_nothing_comes_from_this_computer(store: Store) -> None:
    """Without the header that names the client each request seems to: passwords and metrics are not given away."""
    headers = _of_jeff(store)
    application_ = application(store, replace(SMALL, proxied=True))
    with TestClient(application_, client=("127.0.0.1", 50_000), raise_server_exceptions=False) as proxied:
        assert send(proxied, {"measurement": measurement()}, headers=headers).status_code == 403
        assert proxied.get("/metrics").status_code == 401
        bearer = {"Authorization": f"Bearer {issue(store, 'jeff')}"}
        assert proxied.get("/metrics", headers=bearer).status_code == 200
    with TestClient(application_, base_url="https://testserver", client=("127.0.0.1", 50_000)) as tls:
        assert send(tls, {"measurement": measurement()}, headers=headers).status_code == 201
