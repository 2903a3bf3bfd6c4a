"""``croissant.json``: what is in the tables of an export, for machines (MLCommons Croissant 1.0)."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from palpate.store.exporting.citation import PAPER_BIBTEX, keywords_of, summary_of
from palpate.store.exporting.columns import Column, Table
from palpate.store.exporting.publication import Publication
from palpate.store.exporting.shards import Shard

__all__ = ["Described", "croissant_file"]

PARQUET = "application/x-parquet"
OWN = (
    "citeAs column extract field fileProperty fileObject fileSet format includes isLiveDataset jsonPath key md5 "
    "parentField path recordSet references regex repeated replace samplingRate separator source subField transform "
    "equivalentProperty"
)
CONTEXT: Mapping[str, Any] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    **{name: f"cr:{name}" for name in OWN.split()},
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "rai": "http://mlcommons.org/croissant/RAI/",
    "sc": "https://schema.org/",
}


@dataclass(frozen=True)
class Described:
    """A table with its files."""

    table: Table
    shards: Sequence[Shard]


def croissant_file(data: Publication, tables: Iterable[Described], folder: Path) -> str:
    """The text of ``croissant.json``.

    Parameters
    ----------
    data
        What was written.
    tables
        Where.
    folder
        To which the paths of files are relative.
    """
    found = list(tables)
    census = data.census
    plain = {
        "@context": CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "name": data.title,
        "description": summary_of(data),
        "license": data.licence.reference,
        "creator": [
            {"@type": "sc:Person" if "," in name else "sc:Organization", "name": name} for name in data.authors
        ],
        "datePublished": data.released.isoformat(),
        "version": f"1.0.0+{data.version}",
        "citeAs": PAPER_BIBTEX,
        # Croissant asks for an address; the digest of all recordings is one that needs no host
        "url": f"urn:sha256:{census.digest}",
        "keywords": keywords_of(data),
        "distribution": [part for one in found for part in _distribution(one, folder)],
        "recordSet": [_record_set(one, folder) for one in found],
    }
    return json.dumps(plain, indent=1, ensure_ascii=False) + "\n"


def _paths(one: Described, folder: Path) -> list[str]:
    return [shard.path.relative_to(folder).as_posix() for shard in one.shards]


def _distribution(one: Described, folder: Path) -> list[Mapping[str, Any]]:
    paths = _paths(one, folder)
    files: list[Mapping[str, Any]] = [
        {
            "@type": "cr:FileObject",
            "@id": path,
            "name": path,
            "contentUrl": path,
            "contentSize": f"{shard.path.stat().st_size} B",
            "encodingFormat": PARQUET,
            "sha256": shard.sha256,
        }
        for path, shard in zip(paths, one.shards, strict=True)
    ]
    if len(files) == 1:
        return files
    # without containedIn, which leads into archives: the files are beside this one
    together = {
        "@type": "cr:FileSet",
        "@id": _together(one.table),
        "name": _together(one.table),
        "description": f"the files of the table {one.table.name}",
        "includes": paths,
        "encodingFormat": PARQUET,
    }
    return [*files, together]


def _record_set(one: Described, folder: Path) -> Mapping[str, Any]:
    table, paths = one.table, _paths(one, folder)
    where = {"fileObject": {"@id": paths[0]}} if len(paths) == 1 else {"fileSet": {"@id": _together(table)}}
    return {
        "@type": "cr:RecordSet",
        "@id": table.name,
        "name": table.name,
        "description": f"Each row is {table.words}.",
        "field": [_field(table, column, where) for column in table.columns],
    }


def _field(table: Table, column: Column, where: Mapping[str, Any]) -> Mapping[str, Any]:
    source: dict[str, Any] = {**where, "extract": {"column": column.name}}
    if column.kind.inside is not None:
        source["transform"] = {"jsonPath": column.kind.inside}
    plain = {
        "@type": "cr:Field",
        "@id": f"{table.name}/{column.name}",
        "name": column.name,
        "description": column.words,
        "dataType": column.kind.croissant,
        "source": source,
    }
    return {**plain, "repeated": True} if column.kind.many else plain


def _together(table: Table) -> str:
    return f"{table.name}-files"
