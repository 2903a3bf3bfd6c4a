"""On which terms measurements are given to others: title, authors, licence, and which recordings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, date, datetime

from palpate.errors import plural
from palpate.store.errors import StoreError
from palpate.store.exporting.census import Census, take_census
from palpate.store.exporting.licences import Licence, licence_named
from palpate.store.exporting.selection import Selection

__all__ = ["LackingError", "Publication", "Terms", "publication"]


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


class LackingError(StoreError):
    """What must be stated before recordings are given to others: all of it, by the name of what states it.

    Parameters
    ----------
    lacking
        Field of `Terms`, or of the format, to what was found and what is expected.
    """

    def __init__(self, lacking: Mapping[str, str]) -> None:
        self.lacking = dict(lacking)
        super().__init__(self.told({}))

    def told(self, names: Mapping[str, str]) -> str:
        """The sentence, with other names for those who state things in another way.

        Examples
        --------
        >>> LackingError({"licence": "found none, expected one"}).told({"licence": "--licence"})
        'export: --licence: found none, expected one'
        """
        return f"export: {'; '.join(f'{names.get(name, name)}: {what}' for name, what in self.lacking.items())}"


def publication(
    selection: Selection, terms: Terms, more: Callable[[Selection], Mapping[str, str]] = lambda given: {}
) -> tuple[Selection, Publication]:
    """Find out what is to be stated, and which recordings are given.

    Parameters
    ----------
    selection, terms
        The recordings, and what is stated of them.
    more
        Asked for the recordings that are given, what else the format lacks.

    Raises
    ------
    LackingError
        If no recording may be given, no single licence or no author is known, or the format lacks something.
    StoreError
        If no recording matches.
    """
    given = selection if terms.include_private else selection.public()
    census, lacking = take_census(given), dict[str, str]()
    if not census.recordings:
        matching = selection.count()
        if not matching:
            raise StoreError("export: no recording matches, expected one at least")
        lacking["include_private"] = f"none of the {plural(matching, 'recording')} that match is public, expected some"
        # so that what else they lack is told at once
        given, census = selection, take_census(selection)
    authors, licence = _authors(census, terms), _licence(census, terms)
    if not authors:
        lacking["authors"] = "no recording names an owner, expected who made the data"
    if licence is None:
        lacking["licence"] = f"found {_licences(census)}, expected one for all"
    lacking |= more(given)
    if lacking or licence is None:
        raise LackingError(lacking)
    return given, Publication(terms.title or _title(census), authors, licence, terms.released, census)


def _title(census: Census) -> str:
    datasets = sorted({dataset for dataset, _ in census.things})
    of = f"{datasets[0]}" if len(datasets) == 1 else plural(len(datasets), "dataset")
    return f"Measurements of {plural(len(census.things), 'object')} of {of}"


def _authors(census: Census, terms: Terms) -> tuple[str, ...]:
    stated = [author.strip() for author in terms.authors if author.strip()]
    return tuple(dict.fromkeys(stated or sorted(owner for owner in census.owners if owner)))


def _licence(census: Census, terms: Terms) -> Licence | None:
    """The one for all recordings; None where there are several or some have none."""
    if terms.licence and terms.licence.strip():
        return licence_named(terms.licence)
    known = {licence_named(name) for name in census.licences if name is not None}
    return known.pop() if len(known) == 1 and None not in census.licences else None


def _licences(census: Census) -> str:
    ranked = sorted(census.licences.items(), key=lambda item: (-item[1], item[0] or ""))
    return ", ".join(f"{name or 'none'} for {plural(count, 'recording')}" for name, count in ranked)
