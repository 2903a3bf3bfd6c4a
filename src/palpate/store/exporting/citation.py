"""How to cite: CITATION.cff of a data set, and the paper whose measurements the store was made for."""

from __future__ import annotations

from collections.abc import Mapping
from importlib.metadata import version
from typing import Any

import yaml

from palpate.errors import plural
from palpate.store.exporting.publication import Publication

__all__ = ["PAPER_BIBTEX", "citation_file", "keywords_of", "summary_of"]

PAPER_AUTHORS = (
    ("Kruzliak", "Andrej"),
    ("Hartvich", "Jiri"),
    ("Patni", "Shubhan P."),
    ("Rustler", "Lukas"),
    ("Behrens", "Jan Kristof"),
    ("Abu-Dakka", "Fares J."),
    ("Mikolajczyk", "Krystian"),
    ("Kyrki", "Ville"),
    ("Hoffmann", "Matej"),
)
PAPER_TITLE = (
    "Interactive Learning of Physical Object Properties Through Robot Manipulation and Database of Object Measurements"
)
PAPER_DOI = "10.1109/IROS58592.2024.10802249"
CONFERENCE = "IEEE/RSJ International Conference on Intelligent Robots and Systems (IROS)"
PAPER_BIBTEX = f"""@inproceedings{{kruzliak2024interactive,
  title     = {{{PAPER_TITLE}}},
  author    = {{{" and ".join(f"{family}, {given}" for family, given in PAPER_AUTHORS)}}},
  booktitle = {{{CONFERENCE}}},
  year      = {{2024}},
  doi       = {{{PAPER_DOI}}}
}}"""


def citation_file(data: Publication) -> str:
    """The text of ``CITATION.cff`` (Citation File Format 1.2.0)."""
    plain: dict[str, Any] = {
        "cff-version": "1.2.0",
        "message": "If you use these data, please cite them and the references below.",
        "type": "dataset",
        "title": data.title,
        "authors": [_author(name) for name in data.authors],
        "date-released": data.released,
        "version": data.version,
        "identifiers": [
            {
                "type": "other",
                "value": f"sha256:{data.census.digest}",
                "description": "SHA-256 of the sorted digests of all recordings",
            }
        ],
        "abstract": summary_of(data),
        "keywords": keywords_of(data),
        "references": [_paper(), _software()],
    }
    if data.licence.listed:
        plain["license"] = data.licence.name
    text: str = yaml.safe_dump(plain, sort_keys=False, allow_unicode=True, width=120)
    return text


def summary_of(data: Publication) -> str:
    """What a data set is, in two sentences made of counts."""
    census = data.census
    if census.first is None or census.last is None:
        return ""
    return (
        f"{plural(census.recordings, 'recording')} of {plural(len(census.things), 'object')} "
        f"with {plural(len(census.setups), 'setup')}, "
        f"recorded from {census.first:%Y-%m-%d} to {census.last:%Y-%m-%d} by {', '.join(census.actions)}. "
        f"Licence: {data.licence.name}."
    )


def keywords_of(data: Publication) -> list[str]:
    """What a data set is about: its actions, each word once."""
    return list(dict.fromkeys(["robotics", "physical object properties", *data.census.actions]))


def _author(name: str) -> Mapping[str, str]:
    family, comma, given = (part.strip() for part in name.partition(","))
    # a group may have a comma in its name, a person has one between two names
    if comma and family and given and "," not in given:
        return {"family-names": family, "given-names": given}
    return {"name": name}


def _paper() -> Mapping[str, Any]:
    return {
        "type": "conference-paper",
        "title": PAPER_TITLE,
        "authors": [{"family-names": family, "given-names": given} for family, given in PAPER_AUTHORS],
        "year": 2024,
        "doi": PAPER_DOI,
        "conference": {"name": CONFERENCE},
    }


def _software() -> Mapping[str, Any]:
    return {
        "type": "software",
        "title": "Palpate",
        "authors": [{"name": "The Palpate authors"}],
        "version": version("palpate"),
        "license": "Apache-2.0",
    }
