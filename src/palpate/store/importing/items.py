"""What an import handles: items to read, what became of them, and the formats that find them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, runtime_checkable
from uuid import NAMESPACE_URL, uuid5

from palpate.store.implausible import implausible
from palpate.store.records import Recording

if TYPE_CHECKING:
    from palpate.store.store import Store

__all__ = ["Fate", "Format", "HoldsMore", "Item", "Outcome", "StatesUnits", "identified"]


class Fate(Enum):
    """What became of an item; one that is mended was there, and got back what was missing of it."""

    NEW = "new"
    KNOWN = "known"
    MENDED = "mended"
    REFUSED = "refused"
    SKIPPED = "skipped"


@dataclass(frozen=True, eq=False)
class Outcome:
    """What became of one item, or of one file that is none.

    Attributes
    ----------
    source
        The file or folder; with the recording's id where it holds several.
    fate
        What became of it.
    reason
        Why it was refused or skipped; None where it was not.
    recording
        What was read; None where nothing was, as when its digest alone told that it is there.
    """

    source: str
    fate: Fate
    reason: str | None = None
    recording: Recording | None = None

    @property
    def implausible(self) -> tuple[str, ...]:
        """What cannot be true in a recording that was kept."""
        return () if self.recording is None or self.fate is Fate.REFUSED else implausible(self.recording)


@dataclass(frozen=True, eq=False)
class Item:
    """One recording that has not been read yet.

    Attributes
    ----------
    source
        The file or folder that it is in, for people.
    read
        Reads it; raises a `PalpateError` or an `OSError` where there is none.
    digest
        Of the recording, where it can be told without reading it: then one that a store has is not read at all.
    is_known_wrong
        Whether its results may be in a unit of another dimension than their property's, see `Store.put_many`.
    was_kept
        Whether a store has had it, see `is_new` of `palpate.store.checks.check`.
    """

    source: str
    read: Callable[[], Recording]
    digest: str | None = None
    is_known_wrong: bool = False
    was_kept: bool = False


class Format(Protocol):
    """One way in which files hold recordings."""

    def owns(self, path: Path) -> bool:
        """Tell whether a file or a whole folder is of this format; its content need not be right."""

    def count(self, path: Path) -> int:
        """How many items there are, for a bar of progress."""

    def items(self, path: Path) -> Iterator[Item | Outcome]:
        """Give the recordings, and what is refused or skipped before it is read.

        Raises
        ------
        PalpateError, OSError
            If nothing, or no more, can be read.
        """


@runtime_checkable
class HoldsMore(Protocol):
    """A format that holds more than recordings."""

    def put_more(self, path: Path, store: Store) -> Iterator[Outcome]:
        """Put the rest into a store that has the recordings, and tell what is new there and what was refused.

        Raises
        ------
        PalpateError, OSError
            If nothing, or no more, can be read.
        """


@runtime_checkable
class StatesUnits(Protocol):
    """A format that says in which units properties are, whichever of its recordings comes first."""

    def units(self, path: Path) -> Mapping[str, str]:
        """Property to a unit of its dimension.

        Raises
        ------
        PalpateError, OSError
            If nothing can be read.
        """


def identified(recording: Recording) -> Recording:
    """A recording of a file that has no id for it, under one of its digest: the same file has the same id again."""
    found = replace(recording, id=uuid5(NAMESPACE_URL, f"palpate:{recording.digest}"))
    # the id is no part of what is hashed, and hashing takes longer than all else here
    vars(found).update(document=recording.document, digest=recording.digest)
    return found
