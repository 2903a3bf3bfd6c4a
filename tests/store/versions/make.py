"""Fill a store of the newest version, for the tests of the migrations that follow it.

Run from the root of the checkout when a migration was added, and never again for that version::

    PYTHONPATH=src:. python -m tests.store.versions.make

It writes ``VERSION.json.gz`` beside this file: what the version before left, brought up to date, and recordings that
were put by the code of today.
"""

import hashlib
import json
import tempfile
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
from sqlalchemy import Connection, inspect, text

from palpate.store import rows
from palpate.store.blobs import FolderBlobs
from palpate.store.database import LATEST, connect, migrate
from palpate.store.describing import change_thing
from palpate.store.entries import Bound, Distribution, FailedEntry, Interval, Value
from palpate.store.keeping_episodes import put_episode
from palpate.store.merging import merge_things
from palpate.store.records import Channel, Device, FileItem, Pose, Recording, Series, Setup, ThingRef
from palpate.store.schema import metadata
from palpate.store.store import Store
from tests.store.made_up import GRIPPER, START, made_episode, squeeze
from tests.store.versions.filled import Filled, filled, versions, write

PICTURE = b"a picture of a mug"
CERAMIC = Distribution("material", {"ceramic": 0.75, "glass": 0.25})


def main() -> None:
    """Write the filled store of the newest version."""
    if LATEST in versions():
        raise SystemExit(f"{LATEST}.json.gz is there already, and what was written once stays as it is")
    # large arrays go to the blobs, and here small ones do, so that the file stays small
    rows.IN_ROW_BYTES = 300
    with tempfile.TemporaryDirectory() as folder:
        store = Store(connect(f"sqlite:///{folder}/store.sqlite"), FolderBlobs(Path(folder) / "blobs"))
        with store:
            _begin(store)
            recordings = _recordings(int(LATEST))
            store.put_many(recordings)
            put_episode(store, made_episode(*recordings, number=int(LATEST), stop="enough", owner="ann"))
            change_thing(store, recordings[0].thing, lambda thing: thing.knowing(CERAMIC, "ann"))
            write(_dumped(store))


def _begin(store: Store) -> None:
    """A store of the version before, brought up to date; the first version begins with rows that no code made yet."""
    before = filled(versions()[-1]) if versions() else None
    migrate(store.engine, "head" if before is None else before.version)
    with store.engine.begin() as connection:
        if before is not None:
            before.insert(connection, store.blobs)
    if before is None:
        one, other = (ThingRef("made_up", "object0", maker=maker) for maker in ("maker", "another"))
        for recording in (squeeze(0), squeeze(1), squeeze(2, thing=one), squeeze(3, thing=other)):
            store.put(recording)
        merge_things(store, ThingRef("made_up", "object1"), ThingRef("made_up", "object0"), who="ann")
        store.blobs.put(hashlib.sha256(PICTURE).hexdigest(), PICTURE)
        with store.engine.begin() as connection:
            _insert_first(connection)
    migrate(store.engine, "head")


def _insert_first(connection: Connection) -> None:
    """Rows of tables of the first version that only later versions have code for."""
    picture = hashlib.sha256(PICTURE).digest()
    insert(connection, "thing_images", thing_id=1, name="front.png", media_type="image/png", blob=picture)
    mass: dict[str, Any] = {"kind": "value", "property": "mass", "value": 330.0, "sd": 2.0, "unit": "g"}
    wood: dict[str, Any] = {
        "kind": "distribution",
        "property": "material",
        "probabilities": {"metal": 0.25, "wood": 0.75},
    }
    for number, known in enumerate((mass, wood), 1):
        more = {"property": known["property"], "document": _json(known), "source": f"page {number}"}
        insert(connection, "thing_properties", id=number, thing_id=1, **more)
    insert(
        connection, "users", id=1, name="ann", email="ann@lab.example", role="editor", created_us=1_700_000_000_000_000
    )
    token = hashlib.sha256(b"a token").digest()
    insert(connection, "tokens", id=1, user_id=1, digest=token, role="reader", created_us=1_700_000_000_000_001)
    _insert_episode(connection)


def _insert_episode(connection: Connection) -> None:
    recording = connection.execute(text("SELECT digest FROM recordings WHERE id = 1")).scalar_one().hex()
    head = {"started_at": "2024-05-01T12:00:00.000000Z", "thing": ["made_up", "object0"], "owner": None}
    document = _json({**head, "header": {"format": "palpate-episode/1", "objective": "mass"}})
    step = _json({"record": {"step": 1}, "recording": recording})
    digest = hashlib.sha256(f"{document}\n{step}".encode()).digest()
    more = {"digest": digest, "started_us": 1_714_564_800_000_000, "thing_id": 1, "document": document}
    insert(connection, "episodes", id=1, uuid=bytes(range(16)), **more)
    insert(connection, "episode_steps", episode_id=1, position=0, recording_id=1, document=step)


def insert(connection: Connection, table: str, **row: Any) -> None:
    """One row, by plain SQL."""
    names, values = ", ".join(row), ", ".join(f":{name}" for name in row)
    connection.execute(text(f"INSERT INTO {table} ({names}) VALUES ({values})"), row)


def _json(plain: Any) -> str:
    return json.dumps(plain, sort_keys=True, separators=(",", ":"))


def _recordings(number: int) -> list[Recording]:
    """All that a recording may hold, in a few; others for each version."""
    moment = START + timedelta(days=number)
    noise = np.random.default_rng(number).integers(0, 255, 900, dtype=np.uint8)
    parts = (
        Channel("sound", "level", None, noise, rate_hz=44100.0),
        Channel("trigger", "state", None, np.array([True, False]), time_s=np.array([0.0, 0.5])),
        Channel("pixels", "level", None, np.zeros((0, 3, 2), np.float16), rate_hz=1.0),
    )
    other = (
        Device("other", "scale", calibrated_on="2024-01-31", calibration={"offset_g": 0.5}),
        Device("other", "lamp"),
    )
    named = {kind: Device(kind, f"{kind} {number}", "maker") for kind in ("arm", "camera", "microphone")}
    whole = Recording(
        recorded_at=moment,
        action="knocking",
        thing=ThingRef(
            "made_up", f"mug {number}", "maker", "Häferl", {"handle": True, "parts": [1, 2.5, None]}, ("cup",)
        ),
        setup=Setup(gripper=GRIPPER, other=other, **named),
        owner="ann",
        licence="CC-BY-4.0",
        visibility="public",
        ground_truth=True,
        software="1.0",
        repository="https://lab.example/code",
        grasp={"width_mm": 40.0},
        gripper_pose=Pose((0.1, 0.2, 0.3), (1.0, 0.0, 0.0, 0.0), "world", {"given": "here"}),
        object_pose=Pose((0.0, 0.0, 0.1), None, "table", {}),
        series=(Series("microphone", parts), Series("nothing", ())),
        files=(FileItem("cam0.png", "image/png", PICTURE), FileItem("note.txt", "text/plain", b"%d" % number)),
        entries=(
            Value("mass", 330.0 + number, 2.0, "g"),
            Value("roundness", 0.5),
            Interval("volume", 300.0, 310.0, "cm^3"),
            Bound("elasticity", above=95.0, unit="kPa"),
            Distribution("material", {"ceramic": 0.9, "glass": 0.1}),
            FailedEntry("it slipped", "density"),
        ),
        log="a line\nand Ümläute\n" * 200,
        notices=("no rotation was given",),
    )
    return [whole, squeeze(100 + number), squeeze(200 + number, visibility="lab", series=(), entries=())]


def _dumped(store: Store) -> Filled:
    """All rows, without the help of what describes the tables."""
    with store.engine.connect() as connection:
        found = {table.name: _rows(connection, table.name) for table in metadata.sorted_tables}
    blobs = {digest: store.blobs.get(digest) for digest, _ in store.blobs.all()}
    digests = {row["uuid"].hex(): row["digest"].hex() for row in found["recordings"]}
    return Filled(LATEST, found, blobs, digests)


def _rows(connection: Connection, table: str) -> list[dict[str, Any]]:
    logical = [one["name"] for one in inspect(connection).get_columns(table) if str(one["type"]) == "BOOLEAN"]
    found = [dict(row) for row in connection.execute(text(f"SELECT * FROM {table} ORDER BY 1, 2")).mappings()]
    return [{**row, **{name: bool(row[name]) for name in logical}} for row in found]


if __name__ == "__main__":
    main()
