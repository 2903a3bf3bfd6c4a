from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from typing import Any
from uuid import uuid4

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from sqlalchemy import select

from palpate.store import schema
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import DamagedError, StoreError
from palpate.store.keeping_episodes import get_episode, put_episode
from palpate.store.listing_episodes import list_episodes
from palpate.store.merging import merge_things
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.verifying import repair, verify
from palpate.store.viewing import Viewer
from tests.store.made_up import attributes, made_episode, squeeze

RECORDINGS = [squeeze(number) for number in range(3)]


@pytest.fixture
def filled(store: Store) -> Store:
    store.put_many(RECORDINGS)
    return store


def test_an_episode_comes_back_as_it_was_put(filled: Store) -> None:
    """By id and by digest, with its steps and links; the same again is the same episode."""
    episode = made_episode(*RECORDINGS, stop="enough is known", owner="ann")
    receipt = put_episode(filled, episode)
    for key in (episode.id, episode.digest):
        found = get_episode(filled, key)
        assert (found.digest, found.records, found.thing) == (episode.digest, episode.records, episode.thing)
    assert (receipt.new, put_episode(filled, episode).new) == (True, False)
    again = put_episode(filled, replace(episode, id=uuid4(), visibility="public"))
    assert (again.id, again.new) == (episode.id, False)
    assert list(verify(filled)) == []


def test_growing_changes_neither_who_sees_it_nor_who_sent_it(filled: Store) -> None:
    """Both were said when it came first; a step that comes later says nothing of them."""
    until = datetime.now(UTC) + timedelta(days=1)
    episode = made_episode(RECORDINGS[0], visibility="lab", embargoed_until=until)
    put_episode(filled, episode, uploader="ann")
    grown = replace(episode, visibility="public", embargoed_until=None).continued({"stop": "enough"})
    assert put_episode(filled, grown, uploader="bob").new
    found = get_episode(filled, episode.id)
    assert (found.stop, found.visibility, found.embargoed_until) == ("enough", "lab", until)
    with filled.engine.connect() as connection:
        assert connection.execute(select(schema.episodes.c.uploaded_by)).scalar_one() == "ann"


@settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow])
@given(attributes, st.lists(attributes, max_size=3))
def test_any_episode_comes_back(local: Store, header: dict[str, Any], told: list[dict[str, Any]]) -> None:
    """Whatever JSON can hold may stand in the lines, and comes back under the same digest."""
    episode = replace(made_episode(), header={**header, "format": "palpate-episode/1"})
    for number, record in enumerate(told, 1):
        plain = {name: value for name, value in record.items() if name != "stop"}
        episode = episode.continued({**plain, "step": number, "action": "weighing"})
    receipt = put_episode(local, episode)
    found = get_episode(local, receipt.id)
    assert (found.digest, found.records) == (episode.digest, episode.records)
    assert list(verify(local)) == []


def test_an_episode_grows(filled: Store) -> None:
    """Put after each step it takes what is new; an older copy of it changes nothing."""
    states = [made_episode()]
    for number, recording in enumerate(RECORDINGS, 1):
        line = {"step": number, "action": recording.action}
        states.append(states[-1].continued(line, recording.digest))
    for state in states:
        assert put_episode(filled, state).new
        assert get_episode(filled, state.id).digest == state.digest
    older = put_episode(filled, states[1])
    assert (older.new, older.digest) == (False, states[-1].digest)
    assert list(verify(filled)) == []


def test_another_episode_of_the_same_id_is_refused(filled: Store) -> None:
    """Neither another header nor other steps take the place of what is there."""
    episode = made_episode(*RECORDINGS[:2])
    put_episode(filled, episode)
    for other in (made_episode(*RECORDINGS, number=1, id=episode.id), made_episode(*RECORDINGS[1:], id=episode.id)):
        with pytest.raises(StoreError, match="is that of another episode"):
            put_episode(filled, other)
    assert get_episode(filled, episode.id).digest == episode.digest


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"started_at": datetime.now(UTC) + timedelta(hours=1)}, "started_at: .* is in the future"),
        ({"started_at": datetime(2024, 5, 1)}, "started_at: .* has no time zone"),
        ({"header": {"format": "palpate-session/1"}}, "header.format: found 'palpate-session/1'"),
        ({"header": {"format": "palpate-episode/1", "x": float("inf")}}, "header.x: found inf"),
        ({"visibility": "secret"}, "visibility: found 'secret'"),
        ({"thing": ThingRef("", "mug")}, "thing.dataset: is empty"),
    ],
)
def test_what_cannot_be_kept_is_refused(filled: Store, changes: Any, message: str) -> None:
    """The error names the field, and nothing is in the store."""
    with pytest.raises(StoreError, match=message):
        put_episode(filled, replace(made_episode(*RECORDINGS), **changes))
    assert list_episodes(filled).rows == ()


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([{"step": 2, "action": "weighing"}], r"steps\[0\].step: found 2, expected 1"),
        ([{"stop": "enough"}, {"step": 2, "action": "weighing"}], r"steps\[0\]: exploration stopped, and steps follow"),
        ([{"step": 1, "action": "weighing", "cost_s": float("nan")}], r"steps\[0\].cost_s: found nan"),
    ],
)
def test_steps_that_do_not_follow_are_refused(filled: Store, lines: list[dict[str, Any]], message: str) -> None:
    """Steps are numbered, and nothing comes after the end."""
    episode = made_episode()
    for line in lines:
        episode = episode.continued(line)
    with pytest.raises(StoreError, match=message):
        put_episode(filled, episode)


def test_a_recording_that_is_not_there_is_refused(filled: Store) -> None:
    """An episode refers to recordings that the store has, and leaves nothing behind where it does not."""
    with pytest.raises(StoreError, match=r"steps\[1\].recording: .* is not in the store"):
        put_episode(filled, made_episode(RECORDINGS[0], squeeze(7)))
    with pytest.raises(StoreError, match="digest: found 'mug'"):
        put_episode(filled, made_episode().continued({"step": 1, "action": "weighing"}, "mug"))
    assert list_episodes(filled).rows == ()
    with pytest.raises(StoreError, match="is not in the store"):
        get_episode(filled, uuid4())


def test_two_at_once_are_one(filled: Store) -> None:
    """Eight threads that put the same episode make one."""
    episode = made_episode(*RECORDINGS)
    with ThreadPoolExecutor(8) as pool:
        receipts = list(pool.map(lambda _: put_episode(filled, episode), range(8)))
    assert sum(receipt.new for receipt in receipts) == 1
    assert len(list_episodes(filled).rows) == 1


def test_lists_go_by_time_and_object(filled: Store) -> None:
    """The last one comes first; pages neither repeat nor leave out one; objects merged into another count."""
    things = [ThingRef("made_up", f"object{number % 2}") for number in range(5)]
    made = [made_episode(number=number, thing=thing) for number, thing in enumerate(things)]
    for episode in made:
        put_episode(filled, episode)
    first = list_episodes(filled, limit=3)
    second = list_episodes(filled, limit=3, cursor=first.cursor)
    assert [row.id for row in (*first.rows, *second.rows)] == [episode.id for episode in reversed(made)]
    assert second.cursor is None
    assert len(list_episodes(filled, thing="object1").rows) == 2
    merge_things(filled, things[0], things[1])
    assert len(list_episodes(filled, thing="object1", dataset="made_up").rows) == 5
    since = made[2].started_at
    assert [row.id for row in list_episodes(filled, since=since, until=made[4].started_at).rows] == [
        made[3].id,
        made[2].id,
    ]
    row = first.rows[0]
    assert (row.network, row.objective, row.actions, row.stop) == ("household", "mass", 0, None)
    with pytest.raises(StoreError, match="cursor: 'mug'"):
        list_episodes(filled, cursor="mug")


def test_pages_of_who_does_not_see_all(filled: Store) -> None:
    """They lead on by the id of an episode that is seen; once it is not, the list is to be begun again."""
    owner, made = Viewer(name="ann"), [made_episode(number=number, owner="ann") for number in range(3)]
    for episode in made:
        put_episode(filled, episode)
    first = list_episodes(filled, limit=2, viewer=owner)
    second = list_episodes(filled, limit=2, cursor=first.cursor, viewer=owner)
    assert [row.id for row in (*first.rows, *second.rows)] == [episode.id for episode in reversed(made)]
    with pytest.raises(StoreError, match="not there to see, begin the list again"):
        list_episodes(filled, cursor=first.cursor, viewer=Viewer())
    with pytest.raises(StoreError, match="expected the cursor of its last page"):
        list_episodes(filled, cursor=list_episodes(filled, limit=2).cursor, viewer=owner)


def damaged(filled: Store, sql: str) -> StoredEpisode:
    episode = made_episode(*RECORDINGS, stop="enough is known")
    put_episode(filled, episode)
    with filled.engine.begin() as connection:
        connection.exec_driver_sql(sql)
    return episode


@pytest.mark.parametrize(
    "sql",
    [
        "UPDATE episodes SET actions = 9",
        "UPDATE episodes SET stop = NULL",
        "UPDATE episode_steps SET recording_id = NULL WHERE position = 1",
    ],
)
def test_what_repeats_the_content_is_mended(filled: Store, sql: str) -> None:
    """Columns and links that are not those of the content are told, and made again."""
    episode = damaged(filled, sql)
    (fault,) = verify(filled)
    assert fault.where == f"episode {episode.id}"
    repair(filled)
    assert list(verify(filled)) == []


@pytest.mark.parametrize(
    "sql",
    [
        "UPDATE episode_steps SET document = '{}' WHERE position = 0",
        "DELETE FROM episode_steps WHERE position = 2",
        "UPDATE episodes SET document = '{}'",
        "UPDATE episodes SET thing_id = 2",
    ],
)
def test_damaged_episodes_are_named_and_never_returned(filled: Store, sql: str) -> None:
    """Another document, a step that is missing, another object: verify names the episode and repair leaves it."""
    episode = damaged(filled, sql)
    (fault,) = repair(filled)
    assert (fault.where, fault.remedy) == (f"episode {episode.id}", None)
    if "thing_id" not in sql:
        with pytest.raises(DamagedError, match="digest"):
            get_episode(filled, episode.id)


def test_what_is_known_is_verified(filled: Store) -> None:
    """What is known of an object and cannot be read is named with the object."""
    with filled.engine.begin() as connection:
        connection.exec_driver_sql(
            "INSERT INTO thing_properties (thing_id, property, source, document) VALUES (1, 'mass', 'x', '{}')"
        )
    assert [fault.where for fault in verify(filled)] == ["object made_up/object0"]
