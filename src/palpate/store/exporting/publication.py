"""On which terms measurements are given to others: title, authors, licence, and which recordings."""

from __future__ import annotations

from dataclasses import dataclass, field
from datetime import UTC, date, datetime

from palpate.errors import plural
from palpate.store.errors import StoreError
from palpate.store.exporting.census import Census, take_census
from palpate.store.exporting.licences import Licence, licence_named
from palpate.store.exporting.selection import Selection

__all__ = ["Publication", "Terms", "publication"]


@dataclass(frozen=True)
class Terms:
    """What is stated by whoever exports; the rest is taken from the recordings.

    Attributes
    ----------
    title
        Of the data set.
    authors
        Who made it, each as ``Family name, Given name`` or as the name of a group.
    licence
        Of all recordings: an SPDX identifier, or any other name.
    include_private
        Whether recordings are taken that are not public.
    released
        The date to state.
    """

    title: str | None = None
    authors: tuple[str, ...] = ()
    licence: str | None = None
    include_private: bool = False
    released: date = field(default_factory=lambda: datetime.now(UTC).date())


@dataclass(frozen=True)
class Publication:
    """A data set as it is described to others."""

    title: str
    authors: tuple[str, ...]
    licence: Licence
    released: date
    census: Census

    @property
    def version(self) -> str:
        """The first digits of the digest of all its recordings."""
        return self.census.digest[:12]


def publication(selection: Selection, terms: Terms) -> tuple[Selection, Publication]:
    """Find out what is to be stated, and which recordings are given.

    Raises
    ------
    StoreError
        If no recording may be given, if no single licence is known, or no author.
    """
    given = selection if terms.include_private else selection.public()
    census = take_census(given)
    if not census.recordings:
        matching = selection.count()
        if not matching:
            raise StoreError("export: no recording matches, expected one at least")
        raise StoreError(
            f"export: found no public recording among the {plural(matching, 'recording')} that match, expected some "
            "(include_private, --include-private, takes the others too)"
        )
    title = terms.title or _title(census)
    return given, Publication(title, _authors(census, terms), _licence(census, terms), terms.released, census)


def _title(census: Census) -> str:
    datasets = sorted({dataset for dataset, _ in census.things})
    of = f"{datasets[0]}" if len(datasets) == 1 else plural(len(datasets), "dataset")
    return f"Measurements of {plural(len(census.things), 'object')} of {of}"


def _authors(census: Census, terms: Terms) -> tuple[str, ...]:
    stated = [author.strip() for author in terms.authors if author.strip()]
    authors = stated or sorted(owner for owner in census.owners if owner)
    if not authors:
        raise StoreError("authors: no recording names an owner, expected an author (authors, --author)")
    return tuple(dict.fromkeys(authors))


def _licence(census: Census, terms: Terms) -> Licence:
    if terms.licence and terms.licence.strip():
        return licence_named(terms.licence)
    known = {licence_named(name) for name in census.licences if name is not None}
    if len(known) == 1 and None not in census.licences:
        return known.pop()
    ranked = sorted(census.licences.items(), key=lambda item: (-item[1], item[0] or ""))
    named = ", ".join(f"{name or 'none'} for {plural(count, 'recording')}" for name, count in ranked)
    raise StoreError(f"licence: found {named}; expected one for all (licence, --licence, states it)")
