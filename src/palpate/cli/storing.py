"""What the commands of `palpate store` share: strings to objects, and telling what was done."""

from __future__ import annotations

import sys
from collections import defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.util import find_spec
from typing import TYPE_CHECKING

import typer

from palpate.errors import PalpateError, choices, extra, near

if TYPE_CHECKING:
    from palpate.store.errors import DamagedError
    from palpate.store.filters import Filter
    from palpate.store.store import Store

__all__ = [
    "LeftOut",
    "check_installed",
    "check_known",
    "check_name",
    "labels_of",
    "moment_of",
    "tell_made",
]


FEW = 12
"""Names are all listed up to this number."""
OPTIONS = {"thing": "--object", "labels": "--label"}
"""Fields of a filter whose options are called otherwise."""
NEEDED = ("alembic", "pyarrow", "sqlalchemy", "yaml", "zstandard")


def check_installed() -> None:
    """Say what is missing where the package was installed without what a store needs."""
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        raise PalpateError(f"palpate store needs {missing[0]}, which is not installed: {extra('store')}")


def tell_made(place: str) -> None:
    """Say on standard error that a store was made: a name that was mistyped makes one too."""
    print(f"palpate: new store made at {place}", file=sys.stderr)


@dataclass
class LeftOut:
    """Recordings and objects that a command had to leave out, to be told when it has printed the others."""

    damaged: list[DamagedError] = field(default_factory=list)

    def tell(self) -> None:
        """Say what is wrong with each on standard error, and end with code 2; do nothing where there is none."""
        for error in self.damaged:
            print("palpate:", " ".join(str(error).split()) + "; left out", file=sys.stderr)
        if self.damaged:
            raise typer.Exit(2)


def check_name(option: str, found: str, names: Iterable[str]) -> None:
    """Refuse what is none of the names that an option takes."""
    if found not in names:
        raise PalpateError(f"{option}: {found!r} was found{near(found, names)}; {choices(names)}")


def labels_of(option: str, texts: Iterable[str]) -> Mapping[str, list[str]]:
    """The labels of each property, from ``PROPERTY=LABEL``."""
    labels = defaultdict[str, list[str]](list)
    for text in texts:
        name, equals, label = text.partition("=")
        if not (name and equals and label):
            raise PalpateError(f"{option}: {text!r} was found, expected PROPERTY=LABEL")
        labels[name].append(label)
    return labels


def check_known(store: Store, wanted: Filter, where: Mapping[str, str] = OPTIONS) -> None:
    """Refuse a name that nothing in the store has; for when nothing matches, as it may be mistyped.

    Parameters
    ----------
    where
        What was typed for a field of the filter, if it was no option of the same name.

    Raises
    ------
    PalpateError
        Naming the option, and the name that was probably meant.
    """
    from palpate.store.unknown import unknown_names

    for one in unknown_names(store, wanted):
        few = f"; {choices(one.known)}" if 0 < len(one.known) <= FEW else ""
        place = where.get(one.field, f"--{one.field}")
        raise PalpateError(f"{place}: the store has no {one.what} {one.name!r}{near(one.name, one.known)}{few}")


def moment_of(option: str, text: str | None) -> datetime | None:
    """A date or time in ISO 8601, in UTC unless it has a time zone."""
    if text is None:
        return None
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        raise PalpateError(f"{option}: {text!r} was found, expected a date or time such as 2024-05-01T14:00") from None
    return moment if moment.utcoffset() is not None else moment.replace(tzinfo=UTC)
