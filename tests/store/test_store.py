from dataclasses import replace
from pathlib import Path
from uuid import UUID, uuid4

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from sqlalchemy import func, select

from palpate.store import schema
from palpate.store.entries import Value
from palpate.store.errors import DamagedError, StoreError, UnavailableError
from palpate.store.records import Channel, Device, FileItem, Recording, Series, Setup, ThingRef
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.made_up import recordings, squeeze


def uploaders(store: Store) -> dict[UUID, str | None]:
    with store.engine.connect() as connection:
        rows = connection.execute(select(schema.recordings.c.uuid, schema.recordings.c.uploaded_by))
        return {UUID(bytes=uuid): name for uuid, name in rows}


def test_who_sent_it_first_is_kept_beside_the_content(store: Store) -> None:
    """The account is no part of the digest; what comes by no account has none."""
    made = [squeeze(number) for number in range(3)]
    store.put(made[0])
    store.put(made[1], uploader="ann")
    assert [receipt.new for receipt in store.put_many(made, uploader="bob")] == [True, True, True]
    assert [receipt.new for receipt in store.put_many(made, uploader="bob")] == [False, False, False]
    assert uploaders(store) == {made[0].id: None, made[1].id: "ann", made[2].id: "bob"}
    assert list(verify(store)) == []


def count(store: Store, table: str = "recordings") -> int:
    with store.engine.connect() as connection:
        return int(connection.execute(select(func.count()).select_from(schema.metadata.tables[table])).scalar_one())


def test_what_was_put_comes_back(store: Store) -> None:
    """A recording comes back by its id and by its digest, to the bit."""
    recording = squeeze(files=(FileItem("cam0.png", "image/png", b"picture"),), log="said\0something", notices=("odd",))
    receipt = store.put(recording)
    assert (receipt.id, receipt.digest, receipt.new) == (recording.id, recording.digest, True)
    assert store.get(recording.id) == recording
    assert store.get(recording.digest) == recording


@settings(
    max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow], deadline=None
)
@given(recordings())
def test_any_recording_comes_back(local: Store, recording: Recording) -> None:
    """Whatever may be kept comes back with the same digest, and under the id that the store says."""
    receipt = local.put(recording)
    found = local.get(receipt.id)
    assert found.digest == receipt.digest == recording.digest
    assert found.series == tuple(
        replace(
            one,
            channels=tuple(replace(c, values=c.values.astype(c.values.dtype.newbyteorder("<"))) for c in one.channels),
        )
        for one in recording.series
    )


def test_the_same_recording_is_kept_once(store: Store) -> None:
    """The same content under another id is the recording that is there, alone and within a batch."""
    first = store.put(squeeze(1))
    again = store.put(squeeze(1))
    assert (again.id, again.new) == (first.id, False)
    receipts = store.put_many([squeeze(2), squeeze(1), squeeze(2)])
    assert [receipt.new for receipt in receipts] == [True, False, False]
    assert receipts[0].id == receipts[2].id
    assert count(store) == 2


def test_known_digests_are_told(store: Store) -> None:
    """Of any number of digests those that are there are told; what is no digest is refused."""
    given = [squeeze(number) for number in range(900)]
    store.put_many(given[::3])
    assert store.known(recording.digest for recording in given) == {recording.digest for recording in given[::3]}
    assert store.known([]) == set()
    with pytest.raises(StoreError, match="'mug': is no digest"):
        store.known(["mug"])


def test_a_store_that_cannot_be_asked_says_so(local: Store) -> None:
    """A database that fails is an error of its own kind, in one sentence."""
    with local.engine.begin() as connection:
        connection.exec_driver_sql("ALTER TABLE recordings RENAME TO others")
    with pytest.raises(UnavailableError, match="no such table"):
        local.known([squeeze().digest])


def test_an_id_belongs_to_one_recording(store: Store) -> None:
    """Another content under an id that is taken is refused."""
    key = uuid4()
    store.put(squeeze(1, id=key))
    with pytest.raises(StoreError, match="is that of another recording"):
        store.put(squeeze(2, id=key))
    with pytest.raises(StoreError, match="is that of another recording"):
        store.put_many([squeeze(3, id=UUID(int=3)), squeeze(4, id=UUID(int=3))])
    assert count(store) == 1


def test_two_recordings_of_a_batch_do_not_hide_whose_an_id_is(store: Store) -> None:
    """One whose id belongs to what another of the batch repeats is refused by its id; nothing is kept."""
    key = uuid4()
    store.put(squeeze(1, id=key))
    with pytest.raises(StoreError, match=f"id: {key} is that of another recording") as refused:
        store.put_many([squeeze(1), squeeze(2, id=key), squeeze(3)])
    assert not isinstance(refused.value, UnavailableError)
    assert count(store) == 1


def test_a_known_recording_needs_no_id(store: Store) -> None:
    """What is there is found by its content, whatever id it comes with, another recording's too."""
    first, second = store.put(squeeze(1)), store.put(squeeze(2))
    again = store.put(squeeze(2, id=first.id))
    assert (again.id, again.new) == (second.id, False)
    assert [one.id for one in store.put_many([squeeze(1, id=first.id), squeeze(2, id=first.id)])] == [
        first.id,
        second.id,
    ]


def test_a_refused_recording_leaves_nothing(store: Store) -> None:
    """Of a batch with one that is refused, nothing is in the store."""
    with pytest.raises(StoreError, match=r"entries\[0\].value: found nan"):
        store.put_many([squeeze(1), squeeze(2, entries=(Value("mass", float("nan"), unit="g"),))])
    with pytest.raises(StoreError, match=r"entries\[1\].unit: unit 'g' is mass"):
        store.put(squeeze(3, entries=(Value("stiffness", 1.0, unit="kPa"), Value("stiffness", 1.0, unit="g"))))
    assert {table: count(store, table) for table in ("recordings", "things", "setups", "properties")} == {
        "recordings": 0,
        "things": 0,
        "setups": 0,
        "properties": 0,
    }


def test_a_property_keeps_its_dimension(store: Store) -> None:
    """The first unit of a property decides its dimension, for recordings that come later too."""
    store.put(squeeze(1, entries=(Value("fluff", 1.0, unit="kPa"),)))
    store.put(squeeze(2, entries=(Value("fluff", 1.0, unit="MPa"),)))
    with pytest.raises(StoreError, match=r"entries\[0\].unit: unit 'g' is mass"):
        store.put(squeeze(3, entries=(Value("fluff", 1.0, unit="g"),)))


def test_the_first_unit_of_a_known_property_decides_nothing(store: Store) -> None:
    """In a fresh store too, what everybody knows is refused in a wrong unit, and taken in a right one."""
    with pytest.raises(StoreError, match=r"entries\[0\].unit: unit 'g' is mass; expected .*, as 'Pa'"):
        store.put(squeeze(1, entries=(Value("elasticity", 1.0, unit="g"),)))
    assert store.put(squeeze(2, entries=(Value("elasticity", 1.0, unit="kPa"),))).new


def test_large_arrays_logs_and_files_go_to_the_blobs(store: Store, tmp_path: Path) -> None:
    """What is larger than 64 KiB is stored outside of the rows and comes back."""
    noise = np.random.default_rng(0).integers(0, 255, 200_000, dtype=np.uint8)
    path = tmp_path / "cloud.ply"
    path.write_bytes(noise.tobytes())
    series = (Series("microphone", (Channel("sound", "level", None, noise, rate_hz=44100.0),)),)
    large = squeeze(
        series=series, log="".join(map(chr, noise.astype(int) + 300)), files=(FileItem("cloud", "model/ply", path),)
    )
    store.put(large)
    found = store.get(large.id)
    assert found.series == series
    assert found.log == large.log
    assert found.files[0].data == noise.tobytes()
    assert len(list(store.blobs.all())) == 3


def test_objects_and_setups_are_kept_once(store: Store) -> None:
    """An object is known by dataset and name, a setup by its content; a later description completes an object."""
    store.put(squeeze(0, thing=ThingRef("made_up", "a", common_name="apple")))
    store.put(squeeze(1, thing=ThingRef("made_up", "a", maker="tree", common_name="pomme", attributes={"red": True})))
    store.put(squeeze(2, setup=Setup(gripper=Device("gripper", "two_finger"))))
    found = store.get(store.put(squeeze(0, thing=ThingRef("made_up", "a"))).id)
    assert found.thing == ThingRef("made_up", "a", "tree", "apple", {"red": True}, ("pomme",))
    assert (count(store, "things"), count(store, "setups"), count(store, "devices")) == (2, 2, 2)


def test_contradicting_descriptions_are_noted(store: Store) -> None:
    """What a later description says otherwise is not taken, and stands in the audit."""
    store.put(squeeze(0, thing=ThingRef("made_up", "a", attributes={"red": True})))
    receipt = store.put(squeeze(1, thing=ThingRef("made_up", "a", attributes={"red": False})))
    assert store.get(receipt.id).thing.attributes == {"red": True}
    with store.engine.connect() as connection:
        assert connection.execute(select(schema.audit.c.detail)).scalars().all() == ['{"attributes.red":false}']


def test_unknown_keys_are_refused(local: Store) -> None:
    """A recording that is not there, or a key that is none, is an error in one sentence."""
    with pytest.raises(StoreError, match="is not in the store"):
        local.get(uuid4())
    with pytest.raises(StoreError, match="is no digest"):
        local.get("mug")


def test_damaged_rows_are_never_returned(local: Store) -> None:
    """A recording whose stored content was changed is refused when read."""
    recording = squeeze()
    local.put(recording)
    with local.engine.begin() as connection:
        connection.exec_driver_sql("UPDATE recordings SET document = replace(document, '40.0', '41.0')")
    with pytest.raises(DamagedError, match=str(recording.id)):
        local.get(recording.id)
    assert [fault.where for fault in verify(local)] == [f"recording {recording.id}"]
