"""Options of the commands that open a store: where it is, and which recordings are meant.

A command takes `Place` and `Which` as parameters under `palpate.cli.spreading.spread`.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from palpate.store.filters import Filter
    from palpate.store.store import Store

__all__ = ["Place", "Which", "WideOption"]

PLACE, WHICH = "The store", "Which recordings"

WideOption = Annotated[bool, typer.Option("--wide", help="Whole ids in a terminal too.")]


@dataclass(frozen=True)
class Place:
    """Where the store is."""

    place: Annotated[
        str | None,
        typer.Option(
            "--store",
            help="SQLite file or postgresql+psycopg://... (default: PALPATE_STORE, or your own).",
            rich_help_panel=PLACE,
        ),
    ] = None
    blobs: Annotated[
        str | None,
        typer.Option(
            "--blobs",
            help="Folder or s3://... for large bytes (default: PALPATE_BLOBS, or beside the file).",
            rich_help_panel=PLACE,
        ),
    ] = None

    @contextmanager
    def opened(self, *, make: bool = False) -> Iterator[Store]:
        """The store, closed afterwards; one that is not there is made only where it was asked for."""
        from sqlalchemy.exc import DBAPIError

        from palpate.cli.storing import tell_made
        from palpate.store.errors import UnavailableError
        from palpate.store.opening import open_store

        with open_store(self.place, self.blobs, make=make, made=tell_made) as found:
            try:
                yield found
            except DBAPIError as error:
                raise UnavailableError(f"store {found.engine.url!r}: {error.orig}") from error


@dataclass(frozen=True)
class Which:
    """Which recordings; what was not typed is not asked."""

    thing: Annotated[
        str | None,
        typer.Option("--object", help="Name, common name, alias or DATASET/NAME.", rich_help_panel=WHICH),
    ] = None
    dataset: Annotated[str | None, typer.Option(help="Dataset of the object.", rich_help_panel=WHICH)] = None
    known: Annotated[
        list[str] | None,
        typer.Option(help="PROPERTY=LABEL, known of the object; may be repeated.", rich_help_panel=WHICH),
    ] = None
    action: Annotated[str | None, typer.Option(help="What the robot did.", rich_help_panel=WHICH)] = None
    property: Annotated[
        str | None, typer.Option("--property", help="What there is a result of.", rich_help_panel=WHICH)
    ] = None
    label: Annotated[
        list[str] | None,
        typer.Option(help="PROPERTY=LABEL, the most probable one; may be repeated.", rich_help_panel=WHICH),
    ] = None
    device: Annotated[str | None, typer.Option(help="Any device of the setup.", rich_help_panel=WHICH)] = None
    gripper: Annotated[str | None, typer.Option(help="Gripper of the setup.", rich_help_panel=WHICH)] = None
    setup: Annotated[str | None, typer.Option(help="Digest of the setup, or how it begins.", rich_help_panel=WHICH)] = (
        None
    )
    owner: Annotated[str | None, typer.Option(help="Whose they are.", rich_help_panel=WHICH)] = None
    since: Annotated[str | None, typer.Option(help="Recorded at this time or later.", rich_help_panel=WHICH)] = None
    until: Annotated[str | None, typer.Option(help="Recorded before this time.", rich_help_panel=WHICH)] = None
    ground_truth: Annotated[
        bool | None,
        typer.Option("--ground-truth/--no-ground-truth", help="Known to be true, or not.", rich_help_panel=WHICH),
    ] = None
    text: Annotated[
        str | None, typer.Option(help="Words of names or notices, in any order.", rich_help_panel=WHICH)
    ] = None

    def filter(self, store: Store) -> Filter:
        """The same with objects in the place of strings, and the setup of the store that is meant."""
        from palpate.cli.storing import labels_of, moment_of
        from palpate.store.filters import Filter
        from palpate.store.keys import setup_digest

        return Filter(
            thing=self.thing,
            dataset=self.dataset,
            action=self.action,
            owner=self.owner,
            property=self.property,
            labels=labels_of("--label", self.label or ()),
            known=labels_of("--known", self.known or ()),
            device=self.device,
            gripper=self.gripper,
            setup=None if self.setup is None else setup_digest(store, self.setup),
            since=moment_of("--since", self.since),
            until=moment_of("--until", self.until),
            ground_truth=self.ground_truth,
            text=self.text,
        )
