from datetime import date
from hashlib import sha256

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.exporting.licences import licence_named
from palpate.store.exporting.publication import Publication, Terms, publication
from palpate.store.exporting.selection import Selection
from palpate.store.store import Store
from tests.store.exporting.shared import public


def described(store: Store, **terms: object) -> Publication:
    with Selection.of(store) as selection:
        return publication(selection, Terms(released=date(2026, 1, 2), **terms))[1]  # type: ignore[arg-type]


def test_what_is_stated_comes_from_the_recordings(local: Store) -> None:
    """Owners are the authors, one licence however it is written is the licence, and the title counts."""
    local.put_many([public(1, licence="CC BY 4.0"), public(2, licence="cc-by-4.0", owner="another lab")])
    data = described(local)
    assert data.authors == ("another lab", "our lab")
    assert data.licence.name == "CC-BY-4.0"
    assert data.title == "Measurements of 2 objects of made_up"


@pytest.mark.parametrize(
    ("licences", "message"),
    [
        (("MIT", None), "licence: found none for 1 recording, MIT for 1 recording, expected one for all"),
        (("MIT", "CC0-1.0"), "licence: found CC0-1.0 for 1 recording, MIT for 1 recording, expected one for all"),
        ((" ", None), "licence: found none for 2 recordings, expected one for all"),
    ],
)
def test_a_licence_must_be_known(local: Store, licences: tuple[str | None, ...], message: str) -> None:
    """Licences that differ or are not stated are named in one sentence; stating one settles it."""
    local.put_many([public(number, licence=licence) for number, licence in enumerate(licences)])
    with pytest.raises(StoreError, match=message):
        described(local)
    assert described(local, licence="ODbL 1.0").licence.hub == "odbl"


def test_an_author_must_be_known(local: Store) -> None:
    """Where nobody owns a recording an author must be stated."""
    local.put(public(1, owner=None))
    with pytest.raises(StoreError, match="authors: no recording names an owner, expected who made the data"):
        described(local)
    assert described(local, authors=("Doe, Jane", "Doe, Jane", " ")).authors == ("Doe, Jane",)


def test_something_must_be_public(local: Store) -> None:
    """Where nothing matches, or nothing that may be given, it is told, with how many match."""
    with pytest.raises(StoreError, match="no recording matches, expected one at least"):
        described(local, include_private=True)
    local.put_many([public(number, visibility="lab") for number in range(2)])
    with pytest.raises(StoreError, match="include_private: none of the 2 recordings that match is public"):
        described(local)


def test_the_version_is_made_of_the_recordings(local: Store) -> None:
    """The version follows from which recordings there are, in whatever order they came."""
    made = [public(number) for number in range(4)]
    local.put_many(made[::-1])
    expected = sha256(b"".join(bytes.fromhex(digest) for digest in sorted(each.digest for each in made))).hexdigest()
    data = described(local)
    assert data.census.digest == expected
    assert data.version == expected[:12]


@given(st.sampled_from(["CC-BY-SA-4.0", "MIT", "Apache-2.0", "CC0-1.0"]), st.randoms(), st.sampled_from("- _."))
def test_a_licence_is_known_however_it_is_written(name: str, random, between: str) -> None:
    """Small or large letters, spaces or hyphens make no other licence."""
    text = "".join(random.choice([letter.lower(), letter.upper()]) for letter in name).replace("-", between)
    assert licence_named(text).name == name


@given(st.text(min_size=1))
def test_any_other_licence_keeps_its_name(text: str) -> None:
    """What is no known licence is called as it was."""
    found = licence_named(text)
    assert found.listed or (found.name == text.strip() and found.hub == "other")
