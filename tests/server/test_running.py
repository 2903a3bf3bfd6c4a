"""The command itself: it serves, receives from the client, and stops when told."""

import json
import signal
import socket
import subprocess
import sys
from pathlib import Path
from typing import Any
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import pytest

import palpate
from palpate.client import HttpReceiver, NotAllowedError, RefusedError
from palpate.recording import Outcome, record
from palpate.recording.spool import Spool
from palpate.recording.uploading import upload
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from tests.server.serving import free_port, served
from tests.store.made_up import squeeze


def test_a_port_in_use_is_told_before_anything_else(tmp_path: Path) -> None:
    """By a sentence, with no address and no key that would lead to the other program, and without making a store."""
    place = tmp_path / "store.sqlite"
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = str(other.getsockname()[1])
        command = [sys.executable, "-m", "palpate", "serve", "--store", str(place), "--port", port]
        found = subprocess.run(command, check=False, capture_output=True, text=True, timeout=60)
    assert (found.returncode, found.stdout, place.exists()) == (2, "", False)
    assert f"--port: {port} is in use by another program" in found.stderr


@pytest.mark.parametrize("workers", ["1", "2"])
def test_a_spool_arrives_and_the_server_stops_when_told(tmp_path: Path, workers: str) -> None:
    """Each recording of a spool is in the store to the digest; told to stop, the server ends by itself."""
    place = tmp_path / "store.sqlite"
    with open_store(place) as store:
        add_user(store, "ann", Role.OWNER)
        token = issue(store, "ann")
    spool = Spool(tmp_path / "spool", sync=False)
    recordings = [squeeze(number, owner="ann") for number in range(3)]
    for recording in recordings:
        spool.add(recording)
    with served(place, "--workers", workers) as (address, process):
        receiver = HttpReceiver(f"{address}/api/v1", token)
        assert [one.state for one in upload(spool, receiver)] == ["sent"] * 3
        assert not receiver.put(recordings[0]).new
        with pytest.raises(RefusedError, match="owner: found 'bob', expected 'ann'"):
            receiver.put(squeeze(9, owner="bob"))
        with pytest.raises(NotAllowedError, match="not known"):
            HttpReceiver(f"{address}/api/v1", "wrong").put(recordings[0])
        assert b"palpate_requests_total" in urlopen(f"{address}/metrics").read()
        with pytest.raises(HTTPError, match="421"):
            urlopen(Request(address, headers={"Host": "elsewhere.example"}))
        process.send_signal(signal.SIGTERM)
        assert process.wait(20) in (0, -signal.SIGTERM)
    with open_store(place) as store:
        assert store.known([one.digest for one in recordings]) == {one.digest for one in recordings}


def test_requests_are_logged_where_that_is_wanted(tmp_path: Path) -> None:
    """A line of JSON for each, with what was asked of whom, and without tokens and questions."""
    place = tmp_path / "store.sqlite"
    for options, expected in (("--log", "--workers", "2"), True), ((), False):
        with served(place, *options) as (address, process):
            with pytest.raises(HTTPError, match="401"):
                urlopen(
                    Request(f"{address}/api/v1/recordings?text=secret", headers={"Authorization": "Bearer palpate_x"})
                )
            process.send_signal(signal.SIGTERM)
            _, told = process.communicate(timeout=30)
        lines = [json.loads(line) for line in told.splitlines() if line.startswith("{")]
        asked = [line for line in lines if line["path"] == "/api/v1/recordings"]
        assert bool(asked) == expected
        for line in asked:
            assert (line["method"], line["status"], line["client"]) == ("GET", 401, "127.0.0.1")
            assert line["ms"] > 0
        assert "secret" not in told
        assert "palpate_x" not in told


def test_the_printed_key_opens_what_is_private(tmp_path: Path) -> None:
    """What one's own store holds is seen by whoever started the server, and by nobody else."""
    place = tmp_path / "store.sqlite"
    with open_store(place) as store:
        store.put(squeeze())
    with served(place) as (address, process):
        assert process.stdout is not None
        lines = [process.stdout.readline() for _ in range(3)]
        key = lines[1].rpartition("=")[2].strip()
        asked = Request(f"{address}/api/v1/recordings", headers={"Cookie": f"palpate-key={key}"})
        assert squeeze().digest.encode() in urlopen(asked).read()
        assert squeeze().digest.encode() not in urlopen(f"{address}/api/v1/recordings").read()


@pytest.mark.parametrize("workers", ["1", "2"])
def test_its_address_is_told_once_it_answers(tmp_path: Path, workers: str) -> None:
    """Whoever reads the first line may ask at once; it is told once, however many workers there are."""
    port = str(free_port())
    command = [sys.executable, "-m", "palpate", "serve", "--store", str(tmp_path / "store.sqlite"), "--port", port]
    with subprocess.Popen([*command, "--workers", workers], stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == f"Palpate is at http://127.0.0.1:{port}/ as the public sees it.\n"
            assert urlopen(f"http://127.0.0.1:{port}/health").status == 200
        finally:
            process.send_signal(signal.SIGTERM)
        rest = process.stdout.read().splitlines()
    assert [line.partition(":")[0] for line in rest] == ["As the owner of the store", "Stop it with Ctrl-C."]


def test_what_a_recorder_says_by_default_arrives(tmp_path: Path) -> None:
    """Private and without an owner: who has sent it sees it, and nobody else but administrators."""
    place = tmp_path / "store.sqlite"
    with open_store(place) as store:
        for name, role in (("robot", Role.OWNER), ("bob", Role.OWNER), ("root", Role.ADMIN)):
            add_user(store, name, role)
        tokens = {name: issue(store, name) for name in ("robot", "bob", "root")}
    spool = Spool(tmp_path / "spool", sync=False)

    @record("weighing", thing=ThingRef("ycb", "025_mug"), spool=spool)
    def weigh() -> Any:
        return Outcome.normal("mass", 118.0, sd=2.0, unit="g")

    weigh()
    with served(place) as (address, _):
        service = f"{address}/api/v1"
        (sent,) = upload(spool, HttpReceiver(service, tokens["robot"]))
        assert sent.state == "sent", sent
        seen = {name: list(palpate.Client(service, token).recordings()) for name, token in tokens.items()}
        assert [(one["owner"], one["visibility"]) for one in seen["robot"]] == [(None, "private")]
        assert seen["root"] == seen["robot"]
        assert seen["bob"] == []
