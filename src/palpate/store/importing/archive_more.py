"""What an archive holds beside recordings: objects with what is known of them, merges, and episodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from palpate.store.archive_episodes import EPISODES, archived_episodes, episodes_schema
from palpate.store.archive_rows import blob_of
from palpate.store.archive_things import OBJECTS, archived_thing, objects_schema
from palpate.store.completing import joined_things
from palpate.store.describing import add_thing, change_thing
from palpate.store.embargo import with_embargo
from palpate.store.episodes import StoredEpisode
from palpate.store.errors import StoreError, UnavailableError
from palpate.store.importing.items import Fate, Outcome
from palpate.store.keeping_episodes import put_episode
from palpate.store.merging import merge_things
from palpate.store.reading_archive import opened_table, stated_embargoes
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import Thing, find_thing

if TYPE_CHECKING:
    import pyarrow

__all__ = ["episodes_in", "more_of_archive", "objects_in"]

AT_ONCE = 1000


def more_of_archive(store: Store, folder: Path) -> Iterator[Outcome]:
    """Take over objects and episodes, once the recordings are there.

    What the store says of an object already stays: an archive only completes it.

    Yields
    ------
    Outcome
        One for each episode; of objects, only what could not be taken over.

    Raises
    ------
    UnavailableError
        If the store cannot be used any more.
    StoreError
        If a table is none that palpate wrote.
    """
    things: list[Thing] = []
    for row in objects_in(folder):
        yield from _described(store, folder, row, things)
    for thing in things:
        if thing.merged_into is not None:
            yield from _merged(store, folder, thing, thing.merged_into)
    for key, episode in episodes_in(folder):
        yield _kept(store, f"{folder}: episode {key}", episode)


def objects_in(folder: Path) -> Iterator[Mapping[str, Any]]:
    """The rows of the objects of an archive, for `palpate.store.archive_things.archived_thing`.

    Raises
    ------
    StoreError
        If the table is none that palpate wrote.
    """
    return _rows(folder / OBJECTS, objects_schema())


def episodes_in(folder: Path) -> Iterator[tuple[str, StoredEpisode | str]]:
    """The episodes of an archive: under which id, and the episode, verified, or what is wrong with it.

    Raises
    ------
    StoreError
        If the table is none that palpate wrote.
    """
    stated = stated_embargoes(folder)
    for key, episode in archived_episodes(_rows(folder / EPISODES, episodes_schema())):
        yield key, episode if isinstance(episode, str) else with_embargo(episode, stated)


def _rows(path: Path, columns: pyarrow.Schema) -> Iterator[Mapping[str, Any]]:
    """The rows of a table; none where an archive lacks it."""
    if not path.is_file():
        return
    with opened_table(path) as table:
        if not table.schema_arrow.equals(columns):
            raise StoreError(f"{path}: has other columns, expected those that palpate writes")
        for batch in table.iter_batches(batch_size=AT_ONCE):
            yield from batch.to_pylist()


def _kept(store: Store, source: str, episode: StoredEpisode | str) -> Outcome:
    if isinstance(episode, str):
        return Outcome(source, Fate.REFUSED, episode)
    try:
        receipt = put_episode(store, episode)
    except UnavailableError:
        raise
    except StoreError as error:
        return Outcome(source, Fate.REFUSED, str(error))
    return Outcome(source, Fate.NEW if receipt.new else Fate.KNOWN)


def _described(store: Store, folder: Path, row: Mapping[str, Any], things: list[Thing]) -> Iterator[Outcome]:
    """Complete an object; the ones that were read are added to the list."""
    source, who = f"{folder}: object {row['dataset']}/{row['name']}", f"archive {folder.name}"
    try:
        thing = archived_thing(row)
        add_thing(store, thing.ref, who=who)
        # it is there now, and may count as another one
        things.append(thing)
        for image in thing.images:
            store.blobs.put(image.sha256, blob_of(folder, image.sha256))
        change_thing(store, thing.ref, partial(_completed, other=thing), who=who, is_new=False)
    except UnavailableError:
        raise
    except (ValueError, TypeError, KeyError, OSError) as error:
        reason = str(error) if isinstance(error, StoreError) else f"cannot be read ({error})"
        yield Outcome(source, Fate.REFUSED, reason)


def _completed(here: Thing, other: Thing) -> Thing:
    known = {(one.entry.property, one.source): one for one in (*other.known, *here.known)}
    images = {one.name: one for one in (*other.images, *here.images)}
    ref = joined_things(here.ref, other.ref)
    return replace(here, ref=ref, known=tuple(known.values()), images=tuple(images.values()))


def _merged(store: Store, folder: Path, thing: Thing, into: ThingRef) -> Iterator[Outcome]:
    here = find_thing(store, thing.path).merged_into
    if here is not None and (here.dataset, here.id) == (into.dataset, into.id):
        return
    try:
        if here is not None:
            told = f"counts as {here.dataset}/{here.id} here, and as {into.dataset}/{into.id} in the archive"
            raise StoreError(f"{told}; split it to take that over")
        merge_things(store, thing.ref, into, who=f"archive {folder.name}")
    except UnavailableError:
        raise
    except StoreError as error:
        yield Outcome(f"{folder}: object {thing.path}", Fate.REFUSED, str(error))
