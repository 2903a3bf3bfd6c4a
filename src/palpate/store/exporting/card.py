"""The card of a data set: front matter for the Hugging Face Hub, and what is in it, as counts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping
from importlib.metadata import version
from typing import Any

import yaml

from palpate.errors import plural
from palpate.markdown import cell, table
from palpate.store.exporting.citation import PAPER_BIBTEX, summary_of
from palpate.store.exporting.columns import Table
from palpate.store.exporting.publication import Publication

__all__ = ["contents_part", "front_matter", "measured_part", "quoting_part"]

MOST_ROWS = 100
MOST_NOTICES = 20
SIZES = ((1_000, "n<1K"), (10_000, "1K<n<10K"), (100_000, "10K<n<100K"), (1_000_000, "100K<n<1M"))


def front_matter(data: Publication, rows: int, tags: Iterable[str], configs: Mapping[str, str]) -> str:
    """What the Hub reads: licence, name, tags, size, and which files belong to which table."""
    plain: dict[str, Any] = {"license": data.licence.hub}
    if data.licence.hub == "other":
        plain["license_name"] = data.licence.name
    first = next(iter(configs), None)
    plain |= {
        "pretty_name": data.title,
        "task_categories": ["robotics"],
        "tags": ["palpate", "physical-properties", *tags],
        "size_categories": [_size(rows)],
        "configs": [
            {"config_name": name, "data_files": [{"split": "train", "path": path}]}
            | ({"default": True} if name == first else {})
            for name, path in configs.items()
        ],
    }
    return f"---\n{yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=120)}---\n"


def contents_part(tables: Mapping[Table, int]) -> str:
    """Each table with what a row is, how many there are, and its columns."""
    parts = ["## Tables", table(["table", "a row is", "rows"], _heads(tables))]
    for one in tables:
        rows = [(column.name, column.kind.words, column.words) for column in one.columns]
        parts += [f"### {one.name}", table(["column", "is", "says"], rows)]
    return "\n\n".join(parts)


def measured_part(data: Publication) -> str:
    """What was measured, with what, and what was odd."""
    census = data.census
    parts = ["## What was measured", cell(summary_of(data))]
    parts.append(f"Known to be true: the results of {census.truths} of {plural(census.recordings, 'recording')}.")
    parts.append(_objects(data))
    if census.results:
        rows = [(name, kind, unit, count) for (name, kind, unit), count in _ranked(census.results)]
        parts += ["### Results", table(["property", "kind", "unit", "results"], rows, most=MOST_ROWS)]
    if census.channels:
        signals = [(*key, count) for key, count in _ranked(census.channels)]
        head = ["series", "channel", "quantity", "unit", "recordings"]
        parts += ["### Signals", table(head, signals, most=MOST_ROWS)]
    parts += [
        "## How it was measured",
        table(["setup", "devices", "recordings"], _setups(data), most=MOST_ROWS),
    ]
    if any(census.software):
        programs = [(name or "not stated", count) for name, count in _ranked(census.software)]
        parts.append(table(["program", "recordings"], programs, most=MOST_ROWS))
    if census.notices:
        parts += [
            "## What was odd",
            table(["notice", "recordings"], _ranked(census.notices), most=MOST_NOTICES),
        ]
    return "\n\n".join(parts)


def quoting_part(data: Publication) -> str:
    """Licence, authors, and how to cite."""
    stated = [(name or "not stated", count) for name, count in _ranked(data.census.licences)]
    parts = ["## Licence and citation", f"Licence: {cell(data.licence.name)}."]
    if len(stated) > 1 or stated[0][0] != data.licence.name:
        parts += ["As stated in the recordings:", table(["licence", "recordings"], stated, most=MOST_ROWS)]
    parts.append(
        f"Authors: {cell('; '.join(data.authors))}. Please cite the data as `CITATION.cff` says, and the paper:"
    )
    parts.append(f"```bibtex\n{PAPER_BIBTEX}\n```")
    parts.append(
        f"Version {data.version} is made of the digests of all recordings (SHA-256 {data.census.digest}). "
        f"Written by Palpate {version('palpate')} on {data.released.isoformat()}."
    )
    return "\n\n".join(parts)


def _heads(tables: Mapping[Table, int]) -> Iterable[tuple[str, str, int]]:
    return ((one.name, one.words, rows) for one, rows in tables.items())


def _objects(data: Publication) -> str:
    """Recordings by object and action."""
    census, actions = data.census, data.census.actions
    rows = [
        (
            thing.common_name or thing.id,
            thing.dataset,
            thing.id,
            *[census.measured[key, each] or "" for each in actions],
        )
        for key, thing in sorted(census.things.items())
    ]
    head = ["object", "dataset", "name there", *map(cell, actions)]
    return table(head, rows, most=MOST_ROWS)


def _setups(data: Publication) -> Iterable[tuple[str, str, int]]:
    for digest, count in _ranked(data.census.used):
        named = (
            f"{device.kind} {device.name}" + (f" by {device.maker}" if device.maker else "")
            for device in data.census.setups[digest].devices
        )
        yield digest[:8], ", ".join(named) or "not stated", count


def _ranked(counts: Counter[Any]) -> list[tuple[Any, int]]:
    return sorted(counts.items(), key=lambda item: (-item[1], str(item[0])))


def _size(count: int) -> str:
    return next((name for most, name in SIZES if count < most), "1M<n<10M" if count < 10_000_000 else "n>10M")
