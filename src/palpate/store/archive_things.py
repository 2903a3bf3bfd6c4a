"""Objects in an archive: ``objects.parquet``, a row for each with all that is said and known of it."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import replace
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Connection, literal

from palpate.store.archive_rows import blob_of
from palpate.store.blobs import Blobs
from palpate.store.content import entry_plain, to_json
from palpate.store.decoding import entry_from
from palpate.store.describing import add_thing, change_thing
from palpate.store.errors import DamagedError, StoreError
from palpate.store.merging import merge_things
from palpate.store.records import ThingRef
from palpate.store.registry import joined_things
from palpate.store.store import Store
from palpate.store.things import Image, Known, Thing, find_thing, things_where

if TYPE_CHECKING:
    import pyarrow

__all__ = ["OBJECTS", "import_things", "write_things"]

OBJECTS = "objects.parquet"


@cache
def objects_schema() -> pyarrow.Schema:
    """The columns of ``objects.parquet``."""
    import pyarrow as pa

    text = pa.string()
    known = pa.struct([("property", text), ("source", text), ("document", text)])
    image = pa.struct([("name", text), ("media_type", text), ("sha256", text)])
    return pa.schema(
        [
            *((name, text) for name in ("dataset", "name", "maker", "common_name", "attributes")),
            ("aliases", pa.list_(text)),
            ("known", pa.list_(known)),
            ("images", pa.list_(image)),
            ("merged_into", pa.struct([("dataset", text), ("name", text)])),
        ]
    )


def write_things(connection: Connection, blobs: Blobs, folder: Path, kept: Blobs) -> None:
    """Write all objects, and their images among the blobs of the archive."""
    import pyarrow as pa
    from pyarrow import parquet

    things = list(things_where(connection, literal(True)))
    parquet.write_table(pa.Table.from_pylist(list(map(_row, things)), schema=objects_schema()), folder / OBJECTS)
    for image in (image for thing in things for image in thing.images):
        kept.put(image.sha256, blobs.get(image.sha256))


def import_things(store: Store, folder: Path) -> Iterator[str]:
    """Complete the objects of a store by those of an archive, and give what could not be taken over.

    What the store says already stays: of what both say otherwise, the store's counts.
    """
    from pyarrow import parquet

    things = [_thing(row, folder) for row in parquet.read_table(folder / OBJECTS, schema=objects_schema()).to_pylist()]
    who = f"archive {folder.name}"
    for thing in things:
        try:
            add_thing(store, thing.ref, who=who)
            for image in thing.images:
                store.blobs.put(image.sha256, blob_of(folder, image.sha256))
            change_thing(store, thing.ref, partial(_completed, other=thing), who=who)
        except DamagedError:
            raise
        except StoreError as error:
            yield f"object {thing.path}: {error}"
    for thing in things:
        if thing.merged_into is not None:
            yield from _merge(store, thing, thing.merged_into, who)


def _completed(here: Thing, other: Thing) -> Thing:
    known = {(one.entry.property, one.source): one for one in (*other.known, *here.known)}
    images = {one.name: one for one in (*other.images, *here.images)}
    ref = joined_things(here.ref, other.ref)
    return replace(here, ref=ref, known=tuple(known.values()), images=tuple(images.values()))


def _merge(store: Store, thing: Thing, into: ThingRef, who: str) -> Iterator[str]:
    here = find_thing(store, thing.path)
    wanted = (into.dataset, into.id)
    if here.merged_into is not None:
        if (here.merged_into.dataset, here.merged_into.id) != wanted:
            yield f"object {thing.path}: counts as {into.dataset}/{into.id} in the archive, and as another one here"
        return
    try:
        merge_things(store, thing.ref, into, who=who)
    except StoreError as error:
        yield f"object {thing.path}: {error}"


def _row(thing: Thing) -> dict[str, Any]:
    ref, into = thing.ref, thing.merged_into
    known = [(one.entry.property, one.source, to_json(entry_plain(one.entry))) for one in thing.known]
    return {
        "dataset": ref.dataset,
        "name": ref.id,
        "maker": ref.maker,
        "common_name": ref.common_name,
        "attributes": to_json(ref.attributes),
        "aliases": list(ref.aliases),
        "known": [dict(zip(("property", "source", "document"), one, strict=True)) for one in known],
        "images": [vars(image) for image in thing.images],
        "merged_into": None if into is None else {"dataset": into.dataset, "name": into.id},
    }


def _thing(row: Mapping[str, Any], folder: Path) -> Thing:
    try:
        attributes, into = json.loads(row["attributes"]), row["merged_into"]
        ref = ThingRef(row["dataset"], row["name"], row["maker"], row["common_name"], attributes, tuple(row["aliases"]))
        return Thing(
            ref,
            tuple(Known(entry_from(json.loads(one["document"])), one["source"]) for one in row["known"]),
            tuple(Image(**one) for one in row["images"]),
            None if into is None else ThingRef(into["dataset"], into["name"]),
        )
    except (ValueError, TypeError, KeyError) as error:
        raise DamagedError(f"{folder / OBJECTS}: {row.get('name')!r} cannot be read ({error})") from None
