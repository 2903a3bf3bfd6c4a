"""Blobs that are missing or changed, in folders and in buckets: named, and never returned as data."""

from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

import numpy as np
import pytest

from palpate.store.archive import export_archive
from palpate.store.curves import curves_of_gripper
from palpate.store.errors import DamagedError
from palpate.store.records import Channel, FileItem, Recording, Series
from palpate.store.store import Store
from palpate.store.verifying import repair, verify
from tests.store.made_up import squeeze
from tests.store.places import damage

PICTURE = b"a picture"
NOISE = np.random.default_rng(0).integers(0, 255, 100_000, dtype=np.uint8)
DAMAGES: dict[str, Callable[[bytes], bytes | None]] = {
    "missing": lambda data: None,
    "empty": lambda data: b"",
    "cut": lambda data: data[:-1],
    "longer": lambda data: data + b"\0",
    "first bit": lambda data: bytes([data[0] ^ 1, *data[1:]]),
    "last bit": lambda data: bytes([*data[:-1], data[-1] ^ 128]),
}


def put_large(store: Store) -> tuple[Recording, dict[str, str]]:
    """A recording with a blob of each kind, among others without; the blobs by what they hold."""
    sound = Series("microphone", (Channel("sound", "level", None, NOISE, rate_hz=44100.0),))
    log = "".join(map(chr, NOISE.astype(int) + 300))
    store.put(squeeze(1))
    recording = squeeze(2, series=(sound,), log=log, files=(FileItem("cam0.png", "image/png", PICTURE),))
    store.put(recording)
    store.put(squeeze(3))
    blobs = {digest: store.blobs.get(digest) for digest, _ in store.blobs.all()}
    picture = sha256(PICTURE).hexdigest()
    packed = sorted(set(blobs) - {picture}, key=lambda digest: len(blobs[digest]))
    assert len(packed) == 2
    return recording, {"file": picture, "series": packed[0], "log": packed[1]}


@pytest.mark.parametrize("what", ["file", "series", "log"])
@pytest.mark.parametrize("how", DAMAGES)
def test_a_damaged_blob_is_named_and_never_returned(store: Store, tmp_path: Path, what: str, how: str) -> None:
    """Whatever became of a blob, it is named with its recording, and neither reading nor exporting gives it."""
    recording, digests = put_large(store)
    digest = digests[what]
    damage(store.blobs, digest, DAMAGES[how](store.blobs.get(digest)))
    faults = {fault.where: fault.what for fault in verify(store)}
    assert set(faults) == {f"recording {recording.id}", f"blob {digest}"}
    assert digest in faults[f"recording {recording.id}"]
    with pytest.raises(DamagedError, match=digest):
        store.get(recording.id)
    with pytest.raises(DamagedError, match=digest):
        export_archive(store, tmp_path / "archive")
    assert not (tmp_path / "archive").exists()
    if what == "series":
        with pytest.raises(DamagedError, match=digest):
            list(curves_of_gripper(store, "two_finger"))
    # what is whole is given as before
    assert store.get(squeeze(1).digest).digest == squeeze(1).digest


@pytest.mark.parametrize("how", DAMAGES)
def test_putting_again_restores_what_was_set_aside(store: Store, how: str) -> None:
    """After repair, putting the same recording brings its blobs back, and the store is whole."""
    recording, digests = put_large(store)
    for digest in digests.values():
        damage(store.blobs, digest, DAMAGES[how](store.blobs.get(digest)))
    repair(store)
    assert not store.put(recording).new
    assert store.get(recording.id) == recording
    assert list(verify(store)) == []
