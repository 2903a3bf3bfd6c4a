"""Objects in an archive: ``objects.parquet``, a row for each with all that is said and known of it."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import select

from palpate.store import schema
from palpate.store.blobs import Blobs
from palpate.store.chunks import chunks
from palpate.store.content import entry_plain, to_json
from palpate.store.decoding import entry_from
from palpate.store.errors import DamagedError
from palpate.store.exporting.selection import Selection
from palpate.store.records import ThingRef
from palpate.store.things import Image, Known, Thing, things_by_row
from palpate.store.visible_things import as_known

if TYPE_CHECKING:
    import pyarrow

__all__ = ["OBJECTS", "archived_thing", "objects_schema", "things_with", "write_things"]

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


def things_with(selection: Selection, episodes: Sequence[int]) -> list[int]:
    """Rows of the objects of recordings and episodes, and of those that they count as.

    Where all recordings are selected, so are all objects.
    """
    things, recordings, explored = schema.things.c, schema.recordings.c, schema.episodes.c
    if selection.is_all:
        return list(selection.connection.scalars(select(things.id).order_by(things.id)))
    found = set(
        selection.connection.scalars(select(recordings.thing_id).where(recordings.id.in_(selection.rows())).distinct())
    )
    for ids in chunks(episodes):
        found.update(selection.connection.scalars(select(explored.thing_id).where(explored.id.in_(ids))))
    for ids in chunks(sorted(found)):
        heads = select(things.merged_into).where(things.id.in_(ids), things.merged_into.is_not(None))
        found.update(selection.connection.scalars(heads))
    return sorted(found)


def write_things(selection: Selection, ids: Sequence[int], folder: Path, kept: Blobs) -> list[str]:
    """Write the objects of rows, and their images among the blobs of the archive; tell which images are left out."""
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    left: list[str] = []
    with ParquetWriter(folder / OBJECTS, objects_schema()) as writer:
        for part in chunks(ids):
            things = as_known(
                selection.connection,
                selection.viewer,
                things_by_row(selection.connection, schema.things.c.id.in_(part)),
            )
            rows = [_row(_pictured(thing, selection, kept, left)) for thing in things]
            writer.write_table(pa.Table.from_pylist(rows, schema=objects_schema()))
    return left


def _pictured(thing: Thing, selection: Selection, kept: Blobs, left: list[str]) -> Thing:
    """The object with its images among the blobs; without one that is damaged, where that may be left out."""
    images = []
    for image in thing.images:
        try:
            kept.put(image.sha256, selection.store.blobs.get(image.sha256))
        except DamagedError as error:
            if not selection.forgiving:
                raise
            left.append(f"image {image.name} of object {thing.path}: {error}; left out")
        else:
            images.append(image)
    return replace(thing, images=tuple(images))


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


def archived_thing(row: Mapping[str, Any]) -> Thing:
    """The object of a row.

    Raises
    ------
    ValueError, TypeError, KeyError
        If it is none that palpate wrote.
    """
    into = row["merged_into"]
    attributes = json.loads(row["attributes"])
    return Thing(
        ThingRef(row["dataset"], row["name"], row["maker"], row["common_name"], attributes, tuple(row["aliases"])),
        tuple(Known(entry_from(json.loads(one["document"])), one["source"]) for one in row["known"]),
        tuple(Image(**one) for one in row["images"]),
        None if into is None else ThingRef(into["dataset"], into["name"]),
    )
