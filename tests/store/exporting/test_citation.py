import re
from datetime import date
from pathlib import Path
from typing import Any

import pytest
import yaml

from palpate.store.exporting.citation import citation_file
from palpate.store.exporting.publication import Terms, publication
from palpate.store.exporting.selection import Selection
from palpate.store.store import Store
from tests.store.exporting.shared import public

# of the Citation File Format 1.2.0, https://github.com/citation-file-format/citation-file-format
ROOT = {
    "abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi", "identifiers", "keywords",
    "license", "license-url", "message", "preferred-citation", "references", "repository", "repository-artifact",
    "repository-code", "title", "type", "url", "version",
}  # fmt: skip
PERSON = {"family-names", "given-names", "name-particle", "name-suffix", "affiliation", "orcid", "email", "alias"}
ENTITY = {"name", "address", "city", "country", "date-end", "date-start", "location", "website", "email", "alias"}


def check_authors(authors: Any) -> None:
    assert authors
    for author in authors:
        assert set(author) <= (ENTITY if "name" in author else PERSON)
        assert all(isinstance(value, str) and value for value in author.values())
    assert len({tuple(author.items()) for author in authors}) == len(authors)


def check_citation(plain: Any) -> None:
    """The rules of the format that apply here."""
    assert set(plain) <= ROOT
    assert {"authors", "cff-version", "message", "title"} <= set(plain)
    assert plain["cff-version"] == "1.2.0"
    assert plain["type"] == "dataset"
    assert isinstance(plain["date-released"], date)
    assert all(isinstance(plain[name], str) and plain[name] for name in ("message", "title", "version", "abstract"))
    check_authors(plain["authors"])
    assert len(set(plain["keywords"])) == len(plain["keywords"]) > 0
    for identifier in plain["identifiers"]:
        assert set(identifier) == {"type", "value", "description"}
        assert identifier["type"] in {"doi", "url", "swh", "other"}
    for reference in plain["references"]:
        assert {"authors", "title", "type"} <= set(reference)
        check_authors(reference["authors"])
        assert re.fullmatch(r"10\.\d{4,9}/\S+", reference.get("doi", "10.1234/x"))


@pytest.fixture
def cited(local: Store) -> Any:
    local.put_many([public(1), public(2, action="robotics")])
    terms = Terms(authors=("Doe, Jane", "The lab", "Doe, Jane, and others"), released=date(2026, 1, 2))
    with Selection.of(local) as selection:
        return yaml.safe_load(citation_file(publication(selection, terms)[1]))


def test_a_citation_follows_the_format(cited: Any) -> None:
    """The file has what Citation File Format 1.2.0 asks for and nothing that it does not know."""
    check_citation(cited)
    assert cited["authors"] == [
        {"family-names": "Doe", "given-names": "Jane"},
        {"name": "The lab"},
        {"name": "Doe, Jane, and others"},
    ]
    assert cited["license"] == "CC-BY-4.0"
    assert cited["date-released"] == date(2026, 1, 2)


def test_a_licence_that_is_not_listed_is_named_in_words(local: Store) -> None:
    """The format knows SPDX identifiers only; another licence stands in the abstract."""
    local.put(public(1, licence="for our lab: alone"))
    with Selection.of(local) as selection:
        plain = yaml.safe_load(citation_file(publication(selection, Terms())[1]))
    check_citation(plain)
    assert "license" not in plain
    assert "Licence: for our lab: alone." in plain["abstract"]


def test_the_paper_is_cited_as_by_the_package(cited: Any) -> None:
    """The paper has the authors, the title and the DOI that the package's own CITATION.cff gives it."""
    own = yaml.safe_load((Path(__file__).parents[3] / "CITATION.cff").read_text(encoding="utf-8"))
    paper = cited["references"][0]
    assert paper == own["references"][0]
    assert cited["references"][1]["license"] == own["license"]
    assert cited["references"][1]["authors"] == own["authors"]
