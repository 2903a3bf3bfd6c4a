"""Recordings, episodes and setups by how their ids and digests begin."""

from uuid import UUID

import pytest

from palpate.store.errors import StoreError
from palpate.store.keeping_episodes import put_episode
from palpate.store.keys import episode_id, recording_id, setup_digest
from palpate.store.store import Store
from tests.store.made_up import made_episode, squeeze

FIRST, LAST = UUID("00000000-0000-4000-8000-000000000001"), UUID("ffffffff-ffff-4fff-bfff-ffffffffffff")


def test_every_beginning_that_only_one_has_is_enough(store: Store) -> None:
    """It is compared with all ids and digests: the shortest that is its own leads there, the one before does not."""
    recordings = [squeeze(1, id=FIRST), squeeze(2, id=LAST), *(squeeze(number) for number in range(3, 40))]
    store.put_many(recordings)
    keys = {text: one.id for one in recordings for text in (one.id.hex, one.digest)}
    for text, id in keys.items():
        for length in range(1, 8):
            begins = {other for key, other in keys.items() if key.startswith(text[:length])}
            if begins == {id}:
                assert recording_id(store, text[:length]) == id
            else:
                with pytest.raises(StoreError, match=f"recording {text[:length]}: .*begin so; choose from"):
                    recording_id(store, text[:length])
        assert recording_id(store, text) == id


def test_what_is_no_beginning_is_refused(store: Store) -> None:
    """An empty text, other letters, and one digit too many."""
    store.put(squeeze(1, id=LAST))
    for text in ("", "mug", "-", "0x12", "f" * 65):
        with pytest.raises(StoreError, match="is not the beginning of an id or a digest"):
            recording_id(store, text)
    # longer than an id, it can only be that of a digest
    with pytest.raises(StoreError, match="is not in the store"):
        recording_id(store, LAST.hex + "0")


def test_episodes_and_setups_likewise(store: Store) -> None:
    """An episode has an id and a digest, a setup a digest alone."""
    recording = squeeze(1)
    store.put(recording)
    receipt = put_episode(store, made_episode(recording, stop="nothing left"))
    assert episode_id(store, str(receipt.id)[:9]) == episode_id(store, receipt.digest[:9].upper()) == receipt.id
    assert setup_digest(store, recording.setup.digest[:6]) == recording.setup.digest
    with pytest.raises(StoreError, match="episode 'x': is not the beginning of an id or a digest"):
        episode_id(store, "x")
    with pytest.raises(StoreError, match="setup 'x': is not the beginning of a digest"):
        setup_digest(store, "x")
