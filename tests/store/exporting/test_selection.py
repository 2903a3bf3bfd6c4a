from dataclasses import replace

import numpy as np
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from palpate.store.exporting import selection as module
from palpate.store.exporting.selection import Selection
from palpate.store.filters import Filter
from palpate.store.merging import merge_things
from palpate.store.records import Channel, FileItem, Recording, Series
from palpate.store.store import Store
from tests.store.made_up import recordings, squeeze

MADE = [squeeze(number, visibility="public" if number % 2 else "lab") for number in range(7)]
LONG = Series("long", (Channel("noise", "noise", None, np.random.default_rng(0).normal(size=20_000), 10.0),))


def ids(selection: Selection) -> list[str]:
    return [str(recording.id) for batch in selection.batches() for recording in batch]


def test_recordings_come_in_the_order_in_which_they_came(store: Store) -> None:
    """All that match are given whole, in the order of their arrival, and counted."""
    store.put_many(MADE)
    with Selection.of(store) as found:
        assert [recording for batch in found.batches() for recording in batch] == MADE
        assert found.count() == 7
        assert [outline.digest.hex() for outline in found.outlines()] == [recording.digest for recording in MADE]


def test_filters_select(store: Store) -> None:
    """A filter, on entries too, and what is public, select; conditions hold together."""
    store.put_many([*MADE, replace(squeeze(9), action="weighing", entries=())])
    with Selection.of(store, Filter(thing="object1", property="elasticity")) as found:
        assert ids(found) == [str(MADE[1].id), str(MADE[4].id)]
        assert ids(found.public()) == [str(MADE[1].id)]
        assert found.public().count() == 1


def test_what_comes_later_does_not_count(store: Store) -> None:
    """A selection gives the same recordings each time, whatever is put into the store and changed meanwhile."""
    store.put_many(MADE[:3])
    with Selection.of(store, Filter(thing="object1")) as found:
        store.put_many(MADE[3:])
        merge_things(store, MADE[0].thing, MADE[1].thing)
        assert found.count() == 1
        assert ids(found) == [str(MADE[1].id)]
    with Selection.of(store, Filter(thing="object1")) as found:
        assert found.count() == 5


def test_an_empty_store_gives_nothing(local: Store) -> None:
    """Nothing is selected where nothing is."""
    with Selection.of(local) as found:
        assert not found.count()
        assert not list(found.batches())


def test_what_may_be_large_comes_alone(local: Store) -> None:
    """A recording with files or a long series is not held together with others."""
    filed = squeeze(2, files=(FileItem("cam0.png", "image/png", b"picture"),))
    local.put_many([squeeze(0), squeeze(1), filed, squeeze(3), squeeze(4, series=(LONG,)), squeeze(5), squeeze(6)])
    with Selection.of(local) as found:
        assert [len(batch) for batch in found.batches()] == [2, 1, 1, 1, 2]


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(made=st.lists(recordings(), min_size=1, max_size=4), size=st.integers(1, 3))
def test_pages_lose_nothing(local: Store, monkeypatch, made: list[Recording], size: int) -> None:
    """However many are read at once, each recording is given once, and outlines say the same as recordings."""
    local.put_many(made)
    monkeypatch.setattr(module, "AT_ONCE", size)
    with Selection.of(local) as found:
        whole = [recording for batch in found.batches() for recording in batch]
        assert len({recording.id for recording in whole}) == len(whole) == found.count()
        outlines = list(found.outlines())
        assert [outline.id for outline in outlines] == [recording.id for recording in whole]
        assert [outline.thing for outline in outlines] == [recording.thing for recording in whole]
        assert [outline.setup for outline in outlines] == [recording.setup for recording in whole]
        assert [outline.recorded_at for outline in outlines] == [recording.recorded_at for recording in whole]
