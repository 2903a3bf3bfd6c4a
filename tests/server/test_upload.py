"""The upload form: what comes is shown, and kept when somebody says so; it harms nobody, whatever it is."""

import asyncio
import io
import json
import re
import shutil
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any
from uuid import UUID, uuid4
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
import pytest
from fastapi.testclient import TestClient

from palpate.server.api.sounds import SoundFile
from palpate.server.app import application
from palpate.server.pages.allowance import Allowance
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.server.uploading import drawing, keeping
from palpate.server.uploading.preview import HOLDS_S, Preview
from palpate.server.uploading.previews import MOST_KEPT_OF_ACCOUNT, MOST_OF_ACCOUNT, Previews
from palpate.server.uploading.saving import save
from palpate.store.archive import export_archive
from palpate.store.describing import change_thing
from palpate.store.entries import Distribution, Value
from palpate.store.episodes import StoredEpisode
from palpate.store.importing.intake import import_paths
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.listing import list_recordings
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from palpate.store.parts import head_of
from palpate.store.pictures import png
from palpate.store.records import Channel, FileItem, Recording, Series, ThingRef
from palpate.store.store import Store
from palpate.store.viewing import Viewer, VisibleFilter
from tests.server.conftest import SMALL
from tests.server.packages import package
from tests.server.test_explorations import explored
from tests.store.made_up import squeeze

ORIGIN = {"Origin": "http://testserver"}
HTML = b"<!doctype html><script>alert(1)</script>"
SVG = b'<svg xmlns="http://www.w3.org/2000/svg"><script>alert(1)</script></svg>'
PNG = png(np.full((4, 6, 3), 99, np.uint8), "front")
WAV = b"".join(SoundFile(Channel("knock", "sound pressure", None, np.sin(np.arange(99.0)), rate_hz=8e3)).pieces(0, 999))
COLUMNS = b"""
action = "squeezing"
rate_hz = 100
[channels.position]
unit = "mm"
[channels.force]
unit = "N"
[results.elasticity]
column = "E"
unit = "kPa"
[object]
dataset = "our lab"
id = "sponge"
[recorded]
pattern = '_(?P<time>[0-9T]+)'
format = "%Y%m%dT%H%M"
"""
UPLOADED = {
    "measurement": {
        "object_instance": {"common_name": "banana_ycb", "dataset_id": "011_banana", "dataset": "ycb"},
        "setup": {"gripper": "robotiq_2f85", "camera": "cam1"},
        "sensor_outputs": {"cam1": {"image": "img_cam1.png"}},
    },
    "entry": {
        "name": "cat-vision",
        "type": "categorical",
        "repository": None,
        "values": [{"name": "banana", "probability": 0.75}, {"name": "mug", "probability": 0.25}],
    },
}


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    """A new store in a file: what is put into it is put into others by the same code."""
    with open_store(tmp_path / "store.sqlite", tmp_path / "blobs", durable=False) as found:
        yield found


@pytest.fixture
def ann(store: Store) -> Iterator[TestClient]:
    """The application asked by ann's browser."""
    add_user(store, "ann", Role.OWNER)
    with TestClient(application(store, SMALL), raise_server_exceptions=False) as found:
        found.cookies.set("palpate-session", issue(store, "ann"))
        found.headers.update(ORIGIN)
        yield found


def zipped(files: Mapping[str, bytes]) -> bytes:
    made = io.BytesIO()
    with ZipFile(made, "w", ZIP_DEFLATED) as packed:
        for name, data in files.items():
            packed.writestr(name, data)
    return made.getvalue()


def folder(path: Path) -> dict[str, bytes]:
    return {str(one.relative_to(path)): one.read_bytes() for one in path.rglob("*") if one.is_file()}


def send(client: TestClient, files: Mapping[str, bytes]) -> tuple[str, str]:
    """Upload files by the form; the address and the text of what was understood."""
    found = client.post("/upload", files=[("files", (name, data)) for name, data in files.items()])
    assert found.status_code == 200, found.text
    return str(found.url).removeprefix("http://testserver"), found.text


def fates(text: str) -> dict[str, str]:
    return dict(re.findall(r"<li><strong>([^<]*)</strong> (?:is refused|is left out): ([^<]*)</li>", text))


def test_all_kinds_are_understood_and_kept(ann: TestClient, store: Store, tmp_path: Path) -> None:
    """A package, an archive, an upload dictionary with its picture, CSV with its map, and a bag, in one upload."""
    with open_store(tmp_path / "other.sqlite", tmp_path / "others", durable=False) as other:
        other.put(squeeze(1))
        export_archive(other, tmp_path / "archive")
    rows = "\n".join(["position,force,E", *(f"{60 - row},{row},{12.5}" for row in range(40))])
    address, text = send(
        ann,
        {
            "session.zip": package(squeeze(2, owner="ann", visibility="public")),
            "archive.zip": zipped(folder(tmp_path / "archive")),
            "upload_dict_2022_04_29_16_51_04_cat-vision_0.json": json.dumps(UPLOADED).encode(),
            "img_cam1.png": b"\x89PNG\r\n\x1a\n picture",
            "sponge_20240501T1430.csv": rows.encode(),
            "columns.toml": COLUMNS,
            "notes.txt": b"nothing",
            "broken.json": b"{",
            "run.mcap": b"\x89MCAP0\r\n",
        },
    )
    assert "4 new recordings" in text
    assert text.count("<svg") > 2
    assert "banana 75%" in text
    assert "UTC is assumed" in text
    assert {"notes.txt", "broken.json", "run.mcap"} == fates(text).keys()
    assert list_recordings(store).rows == ()
    found = ann.post(f"{address}/keep", data={"visibility": ""})
    assert found.status_code == 200
    assert "4 recordings are in the store" in found.text
    links = re.findall(r'href="(/recordings/[0-9a-f-]{36})"', found.text)
    assert len(links) == 4
    assert {ann.get(link).status_code for link in links} == {200}
    rows_ = list_recordings(store).rows
    assert {row.owner for row in rows_} == {"ann", None}
    assert sorted(row.visibility for row in rows_) == ["private", "private", "private", "public"]
    entries = {row.action: row.entries for row in rows_ if row.thing in ("011_banana", "sponge")}
    assert entries["cat-vision"] == (Distribution("category", {"banana": 0.75, "mug": 0.25}),)
    assert entries["squeezing"] == (Value("elasticity", 12.5, None, "kPa"),)
    assert str(ann.get(address).url).endswith(f"{address}/kept")


def test_what_was_kept_is_a_page_that_can_be_loaded_again(store: Store, tmp_path: Path) -> None:
    """From any worker, with what was refused and why, as long as an upload waits; only the form itself is sent once."""
    add_user(store, "ann", Role.OWNER)
    cookies, settings = {"palpate-session": issue(store, "ann")}, replace(SMALL, previews=str(tmp_path))
    one, other = (
        TestClient(application(store, settings), cookies=cookies, headers=ORIGIN, follow_redirects=False)
        for _ in range(2)
    )
    files = {
        "good.zip": package(squeeze(2, owner="ann")),
        "cut.zip": package(squeeze(5, owner="ann"))[:-40],
        "of_kim.zip": package(squeeze(6, owner="kim")),
        "notes.txt": b"nothing",
    }
    address = one.post("/upload", files=[("files", item) for item in files.items()]).headers["location"]
    sent = one.post(f"{address}/keep", data={"visibility": ""})
    assert (sent.status_code, sent.headers["location"]) == (303, f"{address}/kept")
    for client in (one, other, one):
        found = client.get(f"{address}/kept")
        assert found.status_code == 200
        assert "1 recording is in the store" in found.text
        assert "2 could not be kept" in found.text
        reasons = fates(found.text)
        assert reasons.keys() == {"cut.zip", "of_kim.zip", "notes.txt"}
        assert "no zip file" in reasons["cut.zip"]
        assert "kim" in reasons["of_kim.zip"]
    for method, where in (("POST", "/keep"), ("GET", "")):
        again = other.request(method, f"{address}{where}", data={} if method == "POST" else None)
        assert (again.status_code, again.headers["location"]) == (303, f"{address}/kept")
    assert sorted(path.name for path in (tmp_path / address.removeprefix("/upload/")).iterdir()) == [
        "about.json",
        "kept.json",
    ]
    one.cookies.set("palpate-session", issue(store, "ann"))
    assert one.get(f"{address}/kept").status_code == 404
    assert len(list_recordings(store).rows) == 1


def waiting(previews: Previews, account: str) -> Preview:
    """An upload of an account that was read, and waits."""
    made = previews.new(f"{account}'s session", account)
    assert made is not None
    (made.folder / "found.json").write_text(json.dumps([{"digest": "0" * 64, "episode": None}]))
    previews.admit(made)
    return made


def test_what_became_of_uploads_is_told_for_a_while(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It takes the place of none that waits, there are so many of an account at most, and then all of it ends."""
    previews = Previews(tmp_path)
    ids = list[str]()
    for _ in range(MOST_KEPT_OF_ACCOUNT + 2):
        made = waiting(previews, "ann")
        assert made.dropped == 0
        with previews.taken(made) as mine:
            assert mine is not None
            mine.note_kept([])
        ids.append(made.id)
    kept = [previews.get_kept(id, "ann's session") is not None for id in ids]
    assert kept == [False] * 2 + [True] * MOST_KEPT_OF_ACCOUNT
    assert previews.get_kept(ids[-1], "kim's session") is None
    later = time.time() + HOLDS_S + 1
    monkeypatch.setattr(time, "time", lambda: later)
    assert previews.get_kept(ids[-1], "ann's session") is None
    previews.sweep()
    assert list(tmp_path.iterdir()) == []


def test_what_is_known_and_what_is_refused_is_told_before(ann: TestClient, store: Store) -> None:
    """Item by item with the reason; the others are kept, with the visibility that is chosen."""
    store.put(squeeze(1, owner="ann"))
    store.put(squeeze(9))  # which lets elasticity be in kPa
    address, text = send(
        ann,
        {
            "known.zip": package(squeeze(1, owner="ann")),
            "good.zip": package(squeeze(2, owner="ann")),
            "of_somebody.zip": package(squeeze(3, owner="kim", visibility="public")),
            "of_other_unit.zip": package(squeeze(4, owner="ann", entries=(Value("elasticity", 1.0, None, "mm"),))),
            "cut.zip": package(squeeze(5, owner="ann"))[:-40],
        },
    )
    assert "1 new recording, 1 known already, <strong>3 refused</strong>" in text
    assert "<button>Keep</button>" in text
    reasons = fates(text)
    assert "kim" in reasons["of_somebody.zip"]
    assert "elasticity" in reasons["of_other_unit.zip"] or "unit" in reasons["of_other_unit.zip"]
    assert "no zip file" in reasons["cut.zip"]
    found = ann.post(f"{address}/keep", data={"visibility": "lab"})
    assert "2 recordings are in the store" in found.text
    assert "was there already" in found.text
    assert sorted(row.visibility for row in list_recordings(store).rows) == ["lab", "private", "private"]


def test_who_may_see_it_and_from_when_on_is_set_before_it_is_kept(ann: TestClient, store: Store) -> None:
    """By the rules of sharing it later; an embargo that is stated holds, another takes its place, or there is none."""
    stated = datetime(2031, 1, 1, tzinfo=UTC)
    wanted: list[tuple[dict[str, str], datetime | None]] = [
        ({}, stated),
        ({"until": "2032-02-03T04:05+02:00"}, datetime(2032, 2, 3, 2, 5, tzinfo=UTC)),
        ({"until": "", "no_embargo": "yes"}, None),
    ]
    for number, (fields, until) in enumerate(wanted):
        sent = squeeze(number, owner="ann", embargoed_until=stated)
        address, text = send(ann, {"one.zip": package(sent)})
        assert "not before 2031-01-01 00:00:00 UTC" in text
        assert "1 recording is in the store" in ann.post(f"{address}/keep", data={"visibility": "lab", **fields}).text
        kept = store.get(sent.digest)
        assert (kept.visibility, kept.embargoed_until) == ("lab", until)
        seen = list_recordings(store, VisibleFilter(viewer=Viewer("kim", lab=True))).rows
        assert any(one.digest == sent.digest for one in seen) == (until is None)


def test_a_wish_that_is_none_is_told_and_nothing_is_lost(ann: TestClient, store: Store) -> None:
    """Above the same page, with what was given; the upload waits on."""
    address, _ = send(ann, {"one.zip": package(squeeze(1, owner="ann"))})
    wrong = {
        "But not before: found &#39;soon&#39;, expected a date and a time": {"until": "soon"},
        "But not before: found the year 9999": {"until": "9999-12-31T00:00"},
        "But not before: found the year 1066": {"until": "1066-10-14T09:00"},
        "beside the wish for no embargo, expected one of the two": {"until": "2032-01-01T00:00", "no_embargo": "yes"},
        "Who may see it: found &#39;everybody&#39;": {"visibility": "everybody"},
    }
    for told, fields in wrong.items():
        found = ann.post(f"{address}/keep", data={"visibility": "public", **fields})
        assert (found.status_code, told in found.text) == (422, True), told
        assert "What was understood" in found.text
        assert f'value="{fields.get("until", "")}"' in found.text
        assert ('<option value="public" selected>' in found.text) == ("visibility" not in fields)
    assert list_recordings(store).rows == ()
    assert "1 recording is in the store" in ann.post(f"{address}/keep", data={"visibility": ""}).text


def archive_of(place: Path, *episodes: StoredEpisode, **changes: Any) -> bytes:
    """An archive as it is exported: a recording, explorations that it belongs to, and what is known of its object."""
    recording = squeeze(1, thing=ThingRef("lab", "jar"), **changes)
    place.mkdir(exist_ok=True)
    with open_store(place / "other.sqlite", place / "others", durable=False) as other:
        other.put(recording)
        for episode in episodes:
            first, *rest = episode.steps
            put_episode(other, replace(episode, steps=(replace(first, recording=recording.digest), *rest)))
        change_thing(other, recording.thing, lambda thing: thing.knowing(Value("mass", 118.0, unit="g"), "a scale"))
        export_archive(other, place / "archive")
    return zipped(folder(place / "archive"))


def archive_with_all(place: Path) -> bytes:
    """One of nobody, with an exploration of somebody else."""
    episodes = (replace(explored(), owner=None), replace(explored(), id=uuid4(), owner="kim"))
    return archive_of(place, *episodes, owner=None)


def test_explorations_of_an_archive_are_kept_with_it(ann: TestClient, store: Store, tmp_path: Path) -> None:
    """Theirs, after the recordings that they name; of others, and of objects, it is told what is not."""
    sent = archive_with_all(tmp_path)
    address, text = send(ann, {"archive.zip": sent})
    assert "1 new recording, 1 new exploration, <strong>1 refused</strong>, 1 left out" in text
    reasons = fates(text)
    (of_kim,) = (reason for source, reason in reasons.items() if "episode" in source)
    assert "owner: found &#39;kim&#39;, expected &#39;ann&#39;" in of_kim
    (of_objects,) = (reason for source, reason in reasons.items() if "objects" in source)
    assert of_objects.startswith("1 known value of lab/jar: nothing of that is taken here; say it on the pages")
    found = ann.post(f"{address}/keep", data={"visibility": "lab", "until": "2032-01-01"}).text
    assert "1 recording is in the store, and 1 exploration" in found
    (link,) = re.findall(r'href="(/episodes/[0-9a-f-]{36})"', found)
    assert ann.get(link).status_code == 200
    kept = get_episode(store, UUID(link.removeprefix("/episodes/")))
    (row,) = list_recordings(store).rows
    assert (kept.steps[0].recording, kept.owner, kept.visibility) == (row.digest, None, "lab")
    assert kept.embargoed_until == datetime(2032, 1, 1, tzinfo=UTC)
    address, text = send(ann, {"archive.zip": sent})
    assert "0 new recordings, 2 known already, <strong>1 refused" in text
    again = ann.post(f"{address}/keep", data={"visibility": ""}).text
    assert again.count("was there already") == 2
    assert len(list_episodes(store).rows) == len(list_recordings(store).rows) == 1


def test_an_exploration_that_cannot_be_kept_is_told(ann: TestClient, store: Store, tmp_path: Path) -> None:
    """One under the id of another that is not seen, and one that no page could show; the recording is kept."""
    mine = replace(explored(), owner="ann")
    put_episode(store, replace(mine, owner="kim", steps=()))
    header = {**mine.header, "belief": {"category": {"probabilities": {"jar": "much"}, "entropy_bits": 0.0}}}
    odd = replace(mine, id=uuid4(), header=header)
    address, text = send(ann, {"archive.zip": archive_of(tmp_path, mine, odd, owner="ann")})
    (reason,) = (reason for source, reason in fates(text).items() if str(odd.id) in source)
    assert "header: belief" in reason
    assert "1 new recording, <strong>2 refused" in text
    assert "its id is that of another exploration" in text
    found = ann.post(f"{address}/keep", data={"visibility": ""}).text
    assert "1 recording is in the store</h1>" in found
    assert f"{mine.id} is that of another exploration" in found
    assert len(list_episodes(store).rows) == 1


def test_an_exploration_that_grew_is_continued(ann: TestClient, store: Store, tmp_path: Path) -> None:
    """What the store has of it stays; by its owner it takes further lines, and the same again changes nothing."""
    mine = replace(explored(), owner="ann")
    recording = squeeze(1, thing=ThingRef("lab", "jar"), owner="ann")
    store.put(recording)
    put_episode(store, replace(mine, steps=(replace(mine.steps[0], recording=recording.digest),)))
    sent = {"archive.zip": archive_of(tmp_path, mine, owner="ann")}
    for there, counted in ((1, "0 new recordings, 1 new exploration, 1 known"), (2, "0 new recordings, 2 known")):
        address, text = send(ann, sent)
        assert f"{counted} already" in text
        assert ("known in part" in text.partition("<h2>Explorations")[2]) == (there == 1)
        found = ann.post(f"{address}/keep", data={"visibility": ""}).text
        assert f'href="/episodes/{mine.id}"' in found
        assert found.count("was there already") == there
        assert len(get_episode(store, mine.id).steps) == len(mine.steps) > 1


def test_cancelled_nothing_stays(ann: TestClient, store: Store) -> None:
    """Neither in the store nor on the disk."""
    address, _ = send(ann, {"one.zip": package(squeeze(1, owner="ann"))})
    root: Path = ann.app.state.palpate.previews.root  # type: ignore[attr-defined]
    assert len(list(root.iterdir())) == 1
    assert ann.post(f"{address}/cancel", follow_redirects=False).status_code == 303
    assert list(root.iterdir()) == []
    assert list_recordings(store).rows == ()
    assert ann.post(f"{address}/keep", data={"visibility": ""}).status_code == 404


def test_who_comes_back_to_a_cancelled_upload_reads_what_became_of_it(ann: TestClient) -> None:
    """Cancelling says so; each address of what waited, also the one to cancel it, leads on to sending it again."""
    ann.headers["Accept"] = "text/html"
    address, _ = send(ann, {"one.zip": package(squeeze(1, owner="ann"))})
    cancelled = ann.post(f"{address}/cancel")
    assert (cancelled.status_code, cancelled.url.path) == (200, "/upload")
    assert 'role="status">The upload was cancelled: nothing of it was kept.' in cancelled.text
    for method, more in (("GET", ""), ("GET", "/kept"), ("POST", "/keep"), ("POST", "/cancel")):
        gone = ann.request(method, f"{address}{more}")
        assert gone.status_code == 404
        assert "<h1>No upload waits here</h1>" in gone.text
        assert "kept or cancelled" in gone.text
        assert 'href="/upload"' in gone.text.partition("<main")[2]


def test_only_the_session_that_sent_it_sees_a_preview(ann: TestClient, store: Store) -> None:
    """For others, for administrators, and for another session of the same account it is not there."""
    address, _ = send(ann, {"one.zip": package(squeeze(1, owner="ann"))})
    add_user(store, "kim", Role.OWNER)
    add_user(store, "root", Role.ADMIN)
    mine = ann.cookies["palpate-session"]
    for name in ("kim", "root", "ann"):
        ann.cookies.set("palpate-session", issue(store, name))
        assert ann.get(address).status_code == 404
        assert ann.post(f"{address}/keep", data={"visibility": ""}).status_code == 404
        assert ann.post(f"{address}/cancel").status_code == 404
    ann.cookies.set("palpate-session", mine)
    assert ann.get(address).status_code == 200
    for odd in ("/upload/" + "x" * 43, "/upload/%2e%2e%2fstore", f"{address}x"):
        assert ann.get(odd).status_code == 404, odd


def test_a_page_elsewhere_uploads_and_keeps_nothing(ann: TestClient, store: Store) -> None:
    """Each form must come from this site."""
    address, _ = send(ann, {"one.zip": package(squeeze(1, owner="ann"))})
    for origin in ("http://evil.example", "null"):
        headers = {"Origin": origin}
        one = [("files", ("one.zip", package(squeeze(2, owner="ann"))))]
        assert ann.post("/upload", files=one, headers=headers).status_code == 403
        assert ann.post("/upload/one", data={"value": "1"}, headers=headers).status_code == 403
        assert ann.post(f"{address}/keep", data={"visibility": "public"}, headers=headers).status_code == 403
        assert ann.post(f"{address}/cancel", headers=headers).status_code == 403
    assert list_recordings(store).rows == ()
    assert ann.get(address).status_code == 200


def test_what_should_be_json_and_is_none_is_told(ann: TestClient) -> None:
    """Without JavaScript too one learns what is broken, and what is JSON of nothing known is told as before."""
    _, text = send(ann, {"broken.json": b'{"a": 1,}', "bytes.JSON": b"\xff\xfe\x00", "fine.json": b'{"a": NaN}'})
    reasons = fates(text)
    assert "is no JSON: " in reasons["broken.json"]
    assert "line 1" in reasons["broken.json"]
    assert "is no JSON: " in reasons["bytes.JSON"]
    assert reasons["fine.json"] == "of no format that palpate knows"


@pytest.mark.parametrize("wrong", [COLUMNS.replace(b"kPa", b"blorp"), b"columns = [", b"\xff"])
def test_files_whose_map_is_wrong_are_not_told_to_send_one(ann: TestClient, wrong: bytes) -> None:
    """A CSV beside a column map that is refused says so; where only a map of topics is wrong, none was sent for it."""
    files = {"one.csv": b"position,force,E\n1,2,3\n", "run.mcap": b"\x89MCAP0\r\n", "map.toml": wrong}
    reasons = fates(send(ann, files)[1])
    assert reasons["one.csv"] == "is CSV, and what its columns mean is not known, as map.toml is refused"
    assert "map.toml" in reasons
    assert ("send a map of topics" in reasons["run.mcap"]) is (b"action" in wrong)
    reasons = fates(send(ann, {**files, "map.toml": b"[topics]\nx = 1\n"})[1])
    assert "send a column map" in reasons["one.csv"]
    assert reasons["run.mcap"] == "is a bag, and what its topics become is not known, as map.toml is refused"


def test_bombs_and_names_that_lead_elsewhere_are_refused(ann: TestClient, tmp_path: Path) -> None:
    """The others of the upload are still shown, and nothing lies outside the folder of the preview."""
    deep = json.dumps(UPLOADED).replace("null", "[" * 100_000 + "]" * 100_000).encode()
    _, text = send(
        ann,
        {
            "good.zip": package(squeeze(1, owner="ann")),
            "bomb.zip": zipped({"zeros": bytes(4 << 20)}),
            "up.zip": zipped({"../../up.txt": b"x"}),
            "absolute.zip": zipped({"/tmp/absolute.txt": b"x"}),
            "drive.zip": zipped({"C:\\drive.txt": b"x"}),
            "../../../out.json": b"{}",
            "upload_dict_2022_04_29_16_51_04_cat-vision_1.json": deep,
        },
    )
    assert "1 new recording" in text
    reasons = fates(text)
    assert "bytes when unpacked" in reasons["bomb.zip"]
    assert "leads out" in reasons["up.zip"]
    assert "absolute" in reasons["absolute.zip"]
    assert "absolute" in reasons["drive.zip"]
    assert "leads out" in reasons["../../../out.json"]
    assert "JSON" in reasons["upload_dict_2022_04_29_16_51_04_cat-vision_1.json"]
    root: Path = ann.app.state.palpate.previews.root  # type: ignore[attr-defined]
    assert not list(root.parent.glob("out.json"))
    assert not Path("/tmp/absolute.txt").exists()
    assert str(root) not in text


def test_of_a_file_that_is_too_large_nothing_is_read(tmp_path: Path) -> None:
    """The beginning of a table would be a recording that nobody has made."""
    rows = b"position,force,E\n" + b"1,2,3\n" * 200_000
    refused = save(iter([("small.csv", io.BytesIO(rows[:23])), ("large.csv", io.BytesIO(rows))]), tmp_path, 1 << 20)
    assert [name for name, _ in refused] == ["large.csv"]
    assert [path.name for path in tmp_path.iterdir()] == ["small.csv"]


def test_a_system_without_limits_for_processes_serves() -> None:
    """As Windows, whose Python has no such module."""
    tried = "import sys; sys.modules['resource'] = None; import palpate.server.app, palpate.server.uploading.reader"
    assert subprocess.run([sys.executable, "-c", tried], capture_output=True, check=False).stderr == b""


def test_a_process_that_has_less_already_asks_for_no_more(tmp_path: Path) -> None:
    """It would be refused, and with it each upload."""
    tried = (
        "import resource as r; r.setrlimit(r.RLIMIT_CPU, (50, 60)); from palpate.server.uploading import limits;"
        "limits.limit_process(); print(r.getrlimit(r.RLIMIT_CPU), r.getrlimit(r.RLIMIT_CORE))"
    )
    found = subprocess.run([sys.executable, "-c", tried], capture_output=True, check=False, text=True)
    assert (found.stdout, found.stderr) == ("(60, 60) (0, 0)\n", "")


def test_files_of_an_upload_come_back_harmless(ann: TestClient, store: Store) -> None:
    """A page, a drawing that runs, and one that is two things at once are downloads of no type when they are kept."""
    files = tuple(
        FileItem(name, kind, data)
        for name, kind, data in (
            ("a.html", "text/html", HTML),
            ("b.svg", "image/svg+xml", SVG),
            ("c.png", "image/png", HTML),
        )
    )
    evil = "<script>alert(1)</script>"
    address, text = send(ann, {"x.zip": package(squeeze(1, owner="ann", files=files, notices=(evil,)))})
    assert "<script>alert" not in text
    assert "&lt;script&gt;" in text
    found = ann.post(f"{address}/keep", data={"visibility": ""})
    link = re.findall(r"/recordings/([0-9a-f-]{36})", found.text)[0]
    for place in range(3):
        back = ann.get(f"/api/v1/recordings/{link}/files/{place}")
        assert back.headers["content-type"] == "application/octet-stream"
        assert back.headers["content-disposition"].startswith("attachment")


def seen(number: int = 0, **changes: Any) -> Recording:
    """A recording that has something to see and to hear, and what is neither."""
    tone = Channel("tone", "sound pressure", "Pa", np.sin(np.arange(8000) / 5), rate_hz=8000.0)
    files = (
        FileItem("front.png", "image/png", PNG),
        FileItem("page.html", "text/html", HTML),
        FileItem("drawing.svg", "image/svg+xml", SVG),
        FileItem("two things.png", "image/png", HTML),
        FileItem("knock.wav", "audio/wav", WAV),
    )
    microphone = Series("microphone", (tone,))
    return squeeze(number, owner="ann", series=(*squeeze(number).series, microphone), files=files, **changes)


def test_what_waits_is_seen_and_heard(ann: TestClient, store: Store) -> None:
    """Pictures and sounds, under their safe types, in parts too; other files wait until they are kept."""
    sent = seen()
    address, text = send(ann, {"one.zip": package(sent)})
    here = f"{address}/recordings/{sent.digest}"
    assert re.findall(r'<img src="(/upload/[^"]*)" alt="([^"]*)"', text) == [(f"{here}/files/0", "front.png")]
    players = re.findall(r'<audio controls preload="none" src="([^"]*)"', text)
    assert players == [f"{here}/series/1/channels/0/sound", f"{here}/files/4"]
    assert text.count("<svg") > 2
    for place, kind, data in ((f"{here}/files/0", "image/png", PNG), (f"{here}/files/4", "audio/wav", WAV)):
        found = ann.get(place)
        assert (found.status_code, found.content, found.headers["content-type"]) == (200, data, kind)
        assert found.headers["content-security-policy"] == "default-src 'none'; sandbox"
        assert found.headers["x-content-type-options"] == "nosniff"
        part = ann.get(place, headers={"Range": "bytes=2-5"})
        assert (part.status_code, part.content) == (206, data[2:6])
    heard = ann.get(players[0])
    assert (heard.headers["content-type"], heard.content[:4], len(heard.content)) == ("audio/wav", b"RIFF", 44 + 16_000)
    odd = [f"files/{place}" for place in (1, 2, 3, 5, -1)]
    for place in (*odd, "series/0/channels/0/sound", "series/9/channels/0/sound", "series/1/channels/9/sound"):
        assert ann.get(f"{here}/{place}").status_code in (404, 422), place
    for digest in ("0" * 64, "x" * 64, sent.digest[:-1], "..%2f" * 3):
        assert ann.get(f"{address}/recordings/{digest}/files/0").status_code == 404, digest
    mine = ann.cookies["palpate-session"]
    add_user(store, "root", Role.ADMIN)
    for name in ("ann", "root"):
        ann.cookies.set("palpate-session", issue(store, name))
        assert [ann.get(place).status_code for place in (f"{here}/files/0", *players)] == [404] * 3
    ann.cookies.set("palpate-session", mine)
    ann.post(f"{address}/keep", data={"visibility": ""})
    assert [ann.get(place).status_code for place in (f"{here}/files/0", *players)] == [404] * 3


def test_so_much_is_shown_and_no_more(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a recording so many curves, pictures and sounds; what is too large is not, and that there is more is told."""
    tones = tuple(
        Channel(f"tone {place}", "sound pressure", "Pa", np.sin(np.arange(9000.0)), rate_hz=9e3) for place in range(6)
    )
    pictures = tuple(FileItem(f"{place}.png", "image/png", PNG + bytes([place])) for place in range(6))
    many = squeeze(1, series=(Series("microphones", tones),), files=pictures)
    few = squeeze(2)
    store.put_many([many, few])
    heads = {one.digest: head_of(store, Viewer(everything=True), one.id) for one in (many, few)}
    first, second = heads[many.digest], heads[few.digest]
    assert first is not None
    assert second is not None
    found = drawing.drawn(store, first, Allowance())
    counted = (len(found.curves), len(found.pictures), len(found.sounds), found.is_more)
    assert counted == (drawing.MOST_CURVES, drawing.MOST_PICTURES, drawing.MOST_SOUNDS, True)
    assert [one.name for one in found.pictures] == ["0.png", "1.png", "2.png", "3.png"]
    plain = drawing.drawn(store, second, Allowance())
    assert (len(plain.curves), plain.pictures, plain.sounds, plain.is_more) == (3, (), (), False)
    monkeypatch.setattr(drawing, "LARGEST_FILE_BYTES", len(PNG))
    assert drawing.drawn(store, first, Allowance(numbers=100)) == drawing.Drawn(is_more=True)


def test_who_may_upload(ann: TestClient, store: Store) -> None:
    """Accounts that may write; only they have it in the menu."""
    assert 'href="/upload"' in ann.get("/").text
    add_user(store, "rita", Role.READER)
    ann.cookies.set("palpate-session", issue(store, "rita"))
    assert ann.get("/upload").status_code == 403
    assert ann.post("/upload/one", data={"value": "1"}).status_code == 403
    assert 'href="/upload"' not in ann.get("/").text
    ann.cookies.clear()
    assert ann.get("/upload").status_code == 401
    assert ann.post("/upload", files=[("files", ("a.zip", b""))]).status_code == 401
    assert 'href="/upload"' not in ann.get("/").text


def test_a_typed_measurement(ann: TestClient, store: Store) -> None:
    """It is kept at once; what is wrong is told above the form, which keeps what was typed."""
    given = {
        "dataset": "our lab",
        "object": "mug",
        "action": "weighing",
        "property": "mass",
        "value": "118.5",
        "sd": "0.5",
        "unit": "g",
        "recorded_at": "2024-05-01T12:00",
        "device": "kitchen scale",
        "kind": "other",
        "visibility": "lab",
    }
    # when it is mostly typed is soon after it was measured
    assert re.search(rf'name="recorded_at" value="{datetime.now(UTC):%Y-%m-%d}T\d\d:\d\d"', ann.get("/upload").text)
    odd = ({"value": "nan"}, {"value": "1e400"}, {"sd": "inf"})
    for wrong in (*odd, {"unit": "blorp"}, {"value": "heavy"}, {"recorded_at": "noon"}, {"object": ""}, {"sd": "-1"}):
        refused = ann.post("/upload/one", data={**given, **wrong})
        assert refused.status_code == 422, wrong
        assert 'role="alert"' in refused.text
        assert "kitchen scale" in refused.text
    for wrong, told in (
        ({"value": "-5"}, "Value: found -5, expected more than 0"),
        ({"value": "heavy", "unit": "", "sd": ""}, "Value: found the label"),
        ({"unit": ""}, "Unit: is missing"),
        ({"property": "elasticity"}, "Unit: unit &#39;g&#39; is mass; expected pressure, as &#39;Pa&#39;"),
        ({"object": ""}, "Object: is empty"),
        (
            {"kind": "toaster"},
            "Kind of device: found &#39;toaster&#39;; choose from &#39;other&#39;, &#39;gripper&#39;",
        ),
        ({"property": "material", "value": "5", "unit": "", "sd": ""}, "material is a label"),
    ):
        assert told in ann.post("/upload/one", data={**given, **wrong}).text
    assert list_recordings(store).rows == ()
    for _ in range(2):
        found = ann.post("/upload/one", data=given)
        assert (found.status_code, "118.5 ± 0.5 g" in found.text) == (200, True)
    (row,) = list_recordings(store).rows
    assert (row.owner, row.visibility, row.entries) == ("ann", "lab", (Value("mass", 118.5, 0.5, "g"),))
    label = {**given, "property": "material", "value": "wood", "unit": "", "sd": ""}
    assert "wood 100%" in ann.post("/upload/one", data=label).text
    assert "SD: found &#39;1&#39; beside the label" in ann.post("/upload/one", data={**label, "sd": "1"}).text
    long = ann.post("/upload/one", data={**label, "object": "a" * 100_000}).text
    assert (
        "Object: found &#39;aaaaaaaaaaaaaaaaaaaa&#39; and so on, 100,000 letters; expected a name of 200 at most"
        in long
    )


def test_a_measurement_typed_again_is_the_old_one(ann: TestClient) -> None:
    """Who sees it stays as it was, and the page says so; the first time it says nothing of it."""
    given = {"dataset": "our lab", "object": "mug", "action": "weighing", "property": "mass", "value": "1", "unit": "g"}
    given["recorded_at"] = "2024-05-01T12:00"
    told = "It was known already: it was kept before, and who sees it did not change."
    first = ann.post("/upload/one", data={**given, "visibility": "public"})
    again = ann.post("/upload/one", data={**given, "visibility": "private"})
    assert (told in first.text, told in again.text) == (False, True)
    assert first.url.path == again.url.path


def test_a_number_that_is_none_is_not_kept(ann: TestClient, store: Store) -> None:
    """It is told which, and nothing is kept."""
    given = {"dataset": "our lab", "object": "mug", "action": "weighing", "property": "mass", "value": "1", "unit": "g"}
    given["recorded_at"] = "2024-05-01T12:00"
    for field, number in (("value", "nan"), ("value", "1e400"), ("sd", "inf"), ("sd", "much")):
        found = ann.post("/upload/one", data={**given, field: number})
        assert (found.status_code, f"{field}: found" in found.text.replace("SD", "sd").replace("Value", "value")) == (
            422,
            True,
        ), (field, number)
    assert list_recordings(store).rows == ()


def test_one_upload_too_many_says_what_made_room(ann: TestClient) -> None:
    """On the page of the new one, beforehand on the form, and at the address of the one that is gone."""
    assert f"{MOST_OF_ACCOUNT} uploads wait for that at most" in ann.get("/upload").text
    sent = [send(ann, {"one.zip": package(squeeze(1, owner="ann"))}) for _ in range(MOST_OF_ACCOUNT)]
    address, text = send(ann, {"notes.txt": b"nothing", "cut.zip": b"PK"})
    assert address.endswith("/kept")
    assert "Nothing of it is kept" in text
    assert fates(text).keys() == {"notes.txt", "cut.zip"}
    assert [ann.get(place).status_code for place, _ in sent] == [200] * MOST_OF_ACCOUNT
    sent.append(send(ann, {"one.zip": package(squeeze(1, owner="ann"))}))
    assert ["1 older upload of yours" in text for _, text in sent] == [False] * MOST_OF_ACCOUNT + [True]
    assert "newer ones took its place" in ann.get(sent[0][0]).text
    assert fates(ann.get(address).text).keys() == {"notes.txt", "cut.zip"}


def test_previews_end(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After a while, and the oldest of an account when it has too many; those of others stay."""
    previews, others = Previews(tmp_path), Previews(tmp_path)
    first, *_ = [waiting(previews, "ann") for _ in range(MOST_OF_ACCOUNT)]
    of_kim = waiting(others, "kim")
    assert others.get(first.id, "ann's session") is not None
    assert others.get(first.id, "kim's session") is None
    # what is being read takes no place yet, and of that there are not more either
    unread = [others.new("ann's session", "ann") for _ in range(MOST_OF_ACCOUNT + 1)]
    assert [one is not None and one.folder.exists() for one in unread] == [False] + [True] * MOST_OF_ACCOUNT
    assert unread[0] is not None
    others.admit(unread[0])
    assert not unread[0].folder.exists()
    assert previews.get(first.id, "ann's session") is not None
    assert waiting(others, "ann").dropped == 1
    assert previews.get(first.id, "ann's session") is None
    assert previews.get(of_kim.id, "kim's session") is not None
    later = time.time() + HOLDS_S + 1
    monkeypatch.setattr(time, "time", lambda: later)
    assert previews.get(of_kim.id, "kim's session") is None
    previews.sweep()
    assert list(tmp_path.iterdir()) == []


def test_what_a_killed_worker_leaves_is_swept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of what it made, read or kept; while others may still be at it, it stays."""
    previews = Previews(tmp_path)
    code = (
        "import sys; from pathlib import Path; from palpate.server.uploading.preview import Preview;"
        "from palpate.server.uploading.previews import Previews; import os, time;"
        "folder = Path(sys.argv[1]); ahead = time.time() + float(sys.argv[3]); time.time = lambda: ahead\n"
        "with Previews(folder).taken(Preview(sys.argv[2], folder / sys.argv[2])): os._exit(9)"
    )
    made = waiting(previews, "ann")
    killed = subprocess.run([sys.executable, "-c", code, str(tmp_path), made.id, str(HOLDS_S / 2)], check=False)
    assert killed.returncode == 9
    assert previews.new("kim's session", "kim") is not None
    (tmp_path / ("x" * 43)).mkdir()
    (tmp_path / "of somebody else").mkdir()
    now = time.time()
    for after_s, left in ((0.9 * HOLDS_S, 4), (1.2 * HOLDS_S, 2), (1.6 * HOLDS_S, 1)):
        moment = now + after_s
        monkeypatch.setattr(time, "time", lambda moment=moment: moment)
        previews.sweep()
        assert len(list(tmp_path.iterdir())) == left, after_s
    assert [path.name for path in tmp_path.iterdir()] == ["of somebody else"]


def test_too_many_of_others_wait(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Then there is no place, and nothing is dropped for it; who has theirs already may send something else instead."""
    monkeypatch.setattr("palpate.server.uploading.previews.MOST", MOST_OF_ACCOUNT + 1)
    previews = Previews(tmp_path)
    made = [waiting(previews, "ann") for _ in range(MOST_OF_ACCOUNT)] + [waiting(previews, "kim")]
    assert previews.new("root's session", "root") is None
    assert previews.new("kim's session", "kim") is None
    assert all(one.is_read for one in made)
    assert waiting(previews, "ann").dropped == 1
    assert [one.is_read for one in made] == [False, True, True, True]


def test_what_is_being_kept_is_removed_by_nobody(tmp_path: Path) -> None:
    """Neither by who cancels it, nor for others of the account; it is kept once, and waits again where that failed."""
    previews, others = Previews(tmp_path), Previews(tmp_path)
    made = waiting(previews, "ann")

    def fail() -> None:
        with previews.taken(made) as mine:
            assert mine is not None
            others.drop(made.id)
            for _ in range(MOST_OF_ACCOUNT + 1):
                waiting(others, "ann")
            assert len(mine.found()) == 1
            with others.taken(made) as second:
                assert second is None
            raise OSError("the disk is full")

    with pytest.raises(OSError, match="full"):
        fail()
    assert previews.get(made.id, "ann's session") is not None
    with previews.taken(made) as mine:
        assert mine is not None
    assert not mine.folder.exists()
    assert previews.get(made.id, "ann's session") is None


@pytest.fixture
def others(ann: TestClient, store: Store) -> Mapping[str, TestClient]:
    """The browsers of kim and of an administrator."""
    found = {}
    for name, role in (("kim", Role.OWNER), ("root", Role.ADMIN)):
        add_user(store, name, role)
        found[name] = TestClient(ann.app, cookies={"palpate-session": issue(store, name)}, headers=ORIGIN)
    return found


def test_what_is_sent_is_kept_as_it_was_sent(ann: TestClient, others: Mapping[str, TestClient], store: Store) -> None:
    """By two people, by the form and by the API, in any order: one recording; its owner is who was first to send it."""
    sent, kim = squeeze(0), others["kim"]
    for client, way in ((ann, "form"), (kim, "api"), (kim, "form"), (ann, "api")):
        if way == "api":
            found = client.put(f"/api/v1/recordings/{sent.digest}", content=package(sent))
            assert found.status_code in (200, 201)
        else:
            address, _ = send(client, {"one.zip": package(sent)})
            kept = client.post(f"{address}/keep", data={"visibility": "", "owner": "somebody"}).text
            assert "1 recording is in the store" in kept
    (row,) = list_recordings(store).rows
    assert (row.digest, row.owner) == (sent.digest, None)
    form = {"visibility": "lab", "until": ""}
    assert [one.post(f"/recordings/{row.id}/sharing", data=form).status_code for one in (kim, ann)] == [403, 200]


def test_a_preview_counts_what_will_be_kept(
    ann: TestClient, others: Mapping[str, TestClient], store: Store, tmp_path: Path
) -> None:
    """Each recording once: what is hidden from who sends it is new to them, and an id is not taken twice."""
    there = [squeeze(number, visibility="private" if number else "public") for number in range(3)]
    store.put_many(there, uploader="ann")
    taken = squeeze(7, id=there[1].id)
    with open_store(tmp_path / "other.sqlite", tmp_path / "others", durable=False) as other:
        other.put_many([squeeze(0), squeeze(5)])
        export_archive(other, tmp_path / "archive")
    files = {f"{number}.zip": package(squeeze(number)) for number in (0, 1, 2, 3)}
    files |= {"again.zip": files["1.zip"], "3 again.zip": files["3.zip"], "taken.zip": package(taken)}
    files |= {"archive.zip": zipped(folder(tmp_path / "archive"))}
    counted = {"ann": (2, 3), "kim": (4, 1), "root": (0, 5)}
    clients = {"ann": ann, **others}
    for name in ("ann", "kim", "root"):
        (new, known), client = counted[name], clients[name]
        address, text = send(client, files)
        words = "recording" if new == 1 else "recordings"
        assert f"{new} new {words}, {known} known already, 3 sent twice, <strong>1 refused" in text, name
        assert "is that of another recording" in fates(text)["taken.zip"]
        assert text.count('class="waiting"') == new + known
        assert "more, which are not shown" not in text
        found = client.post(f"{address}/keep", data={"visibility": "private"}).text
        assert "5 recordings are in the store" in found
        assert found.count("was there already") == known
        assert "is that of another recording" in fates(found)["taken.zip"]


def test_a_preview_that_was_dropped_while_it_was_saved_stays_dropped(tmp_path: Path) -> None:
    """Newer ones of the account took its place: nothing of it is made again, and others are not held up."""
    previews = Previews(tmp_path)
    first, *_ = (previews.new("ann's session", "ann") for _ in range(MOST_OF_ACCOUNT + 1))
    assert first is not None
    with pytest.raises(FileNotFoundError):
        save(iter([("a.txt", io.BytesIO(b"x"))]), first.sent, 1 << 20)
    assert not first.folder.exists()
    first.folder.mkdir()
    (first.folder / "found.json").write_text(json.dumps([{"digest": "0" * 64, "episode": None}]))
    assert not previews.admit(first)
    first.note(dropped=0)
    assert not (first.folder / "about.json").exists()
    assert previews.new("kim's session", "kim") is not None


def test_a_preview_is_gone_before_its_files_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """So that who cannot save a file any more sees why."""
    previews = Previews(tmp_path)
    made, seen = waiting(previews, "ann"), list[object]()
    monkeypatch.setattr(shutil, "rmtree", lambda folder, **_: seen.append(Preview(made.id, folder).about()))
    previews.drop(made.id)
    assert seen == [None]


def test_an_upload_whose_place_is_taken_is_told(ann: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether it happens while it is saved or after; the next one of anybody is taken."""
    previews: Previews = ann.app.state.palpate.previews  # type: ignore[attr-defined]

    def save_late(files: Any, folder: Path, largest: int) -> list[tuple[str, str]]:
        saved = save(files, folder, largest)
        previews.drop(folder.parent.name)
        return saved

    monkeypatch.setattr("palpate.server.pages.upload.save", save_late)
    found = ann.post("/upload", files=[("files", ("a.zip", package(squeeze(1, owner="ann"))))])
    assert (found.status_code, "newer ones took its place" in found.text) == (404, True)
    assert list(previews.root.iterdir()) == []
    monkeypatch.undo()
    assert "1 new recording" in send(ann, {"a.zip": package(squeeze(1, owner="ann"))})[1]


@pytest.mark.parametrize("damaged", ['{"dropped": 0}', "[]", "", '{"expires": "soon"}', "\ud800"])
def test_a_damaged_note_holds_up_nobody(tmp_path: Path, damaged: str) -> None:
    """What it belongs to is over, and is swept."""
    previews = Previews(tmp_path)
    made = waiting(previews, "ann")
    (made.folder / "about.json").write_bytes(damaged.encode("utf-8", "surrogatepass"))
    assert previews.get(made.id, "ann's session") is None
    assert waiting(previews, "kim").dropped == 0
    assert not made.folder.exists()


def test_sweeping_goes_on_where_one_cannot_be_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """The others are swept, and so they are the next time."""
    previews = Previews(tmp_path)
    bad, good = waiting(previews, "ann"), waiting(previews, "ann")
    read_text = Path.read_text

    def refuse(path: Path, *given: Any, **named: Any) -> str:
        if bad.id in str(path):
            raise PermissionError(13, "Permission denied", str(path))
        return read_text(path, *given, **named)

    monkeypatch.setattr(Path, "read_text", refuse)
    later = time.time() + HOLDS_S + 1
    monkeypatch.setattr(time, "time", lambda: later)
    previews.sweep()
    assert [path.name for path in tmp_path.iterdir()] == [bad.id]
    assert "cannot be swept" in caplog.text
    sweeps = iter([OSError(5, "Input/output error"), RuntimeError("it goes on")])

    def fail(_: Previews) -> None:
        raise next(sweeps)

    monkeypatch.setattr(Previews, "sweep", fail)
    monkeypatch.setattr("palpate.server.uploading.previews.SWEPT_EACH_S", 0.0)
    with pytest.raises(RuntimeError, match="it goes on"):
        asyncio.run(previews.watch())
    assert not good.folder.exists()


def test_what_is_known_is_told_to_everybody_who_sees_it(
    ann: TestClient, others: Mapping[str, TestClient], store: Store
) -> None:
    """Unchanged, whosever it is; what is hidden is refused as if it were new, and who sends it gains no sight of it."""
    there = [squeeze(number, owner="kim", visibility=seen) for number, seen in enumerate(("public", "private"))]
    public, hidden = store.put_many(there, uploader="kim")
    address, text = send(ann, {"known.zip": package(there[0])})
    assert "0 new recordings, 1 known already." in text
    assert "Nothing of it is new, so that there is nothing to keep." in text
    assert "<button>Keep</button>" not in text
    assert f'<a href="/recordings/{public.id}">known already</a>' in text
    kept = ann.post(f"{address}/keep", data={"visibility": "private"}).text
    assert kept.count("was there already") == 1
    form = {"visibility": "private", "until": ""}
    assert others["kim"].post(f"/recordings/{public.id}/sharing", data=form).status_code == 200
    assert ann.get(f"/recordings/{public.id}").status_code == 404
    _, text = send(ann, {"hidden.zip": package(there[1]), "new.zip": package(squeeze(2, owner="kim"))})
    assert "Nothing of it is kept" in text
    for reason in (fates(text)["hidden.zip"], fates(text)["new.zip"]):
        assert reason == (
            "owner: found &#39;kim&#39;, expected &#39;ann&#39;, in whose name this is sent, or leave the owner out"
        )
    assert ann.get(f"/recordings/{hidden.id}").status_code == 404


def test_what_is_hidden_before_it_is_kept_is_refused(
    ann: TestClient, others: Mapping[str, TestClient], store: Store
) -> None:
    """On the page that is loaded again, and when it is kept."""
    (public,) = store.put_many([squeeze(0, owner="kim", visibility="public")], uploader="kim")
    sent = package(squeeze(0, owner="kim", visibility="public"))
    address, text = send(ann, {"known.zip": sent})
    assert "1 known already" in text
    others["kim"].post(f"/recordings/{public.id}/sharing", data={"visibility": "private", "until": ""})
    assert "owner: found &#39;kim&#39;" in fates(ann.get(address).text)["known.zip"]
    kept = ann.post(f"{address}/keep", data={"visibility": ""}).text
    assert "owner: found &#39;kim&#39;" in fates(kept)["known.zip"]
    assert ann.get(f"/recordings/{public.id}").status_code == 404


def test_an_empty_zip_is_told(ann: TestClient, store: Store, tmp_path: Path) -> None:
    """Also one of folders alone, and an archive of nothing."""
    bare = io.BytesIO()
    with ZipFile(bare, "w") as packed:
        packed.mkdir("empty")
    _, text = send(ann, {"empty.zip": zipped({}), "bare.zip": bare.getvalue()})
    assert "Nothing of it is kept" in text
    assert fates(text) == {"empty.zip": "the zip is empty", "bare.zip": "the zip is empty"}
    export_archive(store, tmp_path / "archive")
    _, text = send(ann, {"archive.zip": zipped(folder(tmp_path / "archive"))})
    assert "Nothing of it is kept" in text
    assert "holds no recording" in text


def test_kept_several_times_at_once(ann: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    """One keeps it, and the others are led to what became of it, which is told when it is done."""
    address, _ = send(ann, {"one.zip": package(squeeze(1, owner="ann"))})
    asked = list[tuple[int, str]]()

    def keep_slowly(*given: Any, **named: Any) -> Any:
        for method, place in (("POST", "/keep"), ("GET", "")):
            data = {"visibility": ""} if method == "POST" else None
            found = ann.request(method, f"{address}{place}", data=data, follow_redirects=False)
            asked.append((found.status_code, found.headers["location"]))
        busy = ann.get(f"{address}/kept")
        assert (busy.status_code, busy.headers["refresh"]) == (200, "2")
        assert "being kept" in busy.text
        return import_paths(*given, **named)

    monkeypatch.setattr(keeping, "import_paths", keep_slowly)
    assert "1 recording is in the store" in ann.post(f"{address}/keep", data={"visibility": ""}).text
    assert asked == [(303, f"{address}/kept")] * 2
    assert len(list_recordings(store).rows) == 1


def test_what_waits_is_found_again(ann: TestClient, others: Mapping[str, TestClient]) -> None:
    """By who closed the tab, on the page to upload; by nobody else, and only while it waits."""
    assert "wait to be kept" not in ann.get("/upload").text
    address, _ = send(ann, {"session.zip": package(squeeze(1, owner="ann")), "notes.txt": b"nothing"})
    text = ann.get("/upload").text
    assert re.search(rf'<a href="{address}">notes.txt, session.zip</a>, until \d{{4}}-', text), text
    assert address not in others["kim"].get("/upload").text
    # what was understood cannot be lost from the page of what was never kept
    assert str(ann.get(f"{address}/kept").url).endswith(address)
    ann.post(f"{address}/cancel")
    assert address not in ann.get("/upload").text
