"""Options of the commands that fit a network, for `palpate.cli.spreading.spread`: which data, and how it is fitted."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["How", "Keep", "OfStore", "Tables"]

OF_STORE, OF_TABLES, HOW = "Which data of the store", "Tables in place of a store", "How it is fitted"

Keep = Annotated[
    list[str] | None,
    typer.Option(help="A property or action whose numbers are kept; may be repeated.", rich_help_panel=HOW),
]


@dataclass(frozen=True)
class OfStore:
    """What of a store counts; what was not typed is not asked."""

    dataset: Annotated[str | None, typer.Option(help="Only its objects.", rich_help_panel=OF_STORE)] = None
    device: Annotated[str | None, typer.Option(help="Only readings of setups with it.", rich_help_panel=OF_STORE)] = (
        None
    )
    gripper: Annotated[str | None, typer.Option(help="Only readings with it.", rich_help_panel=OF_STORE)] = None
    since: Annotated[
        str | None, typer.Option(help="Only readings at this time or later.", rich_help_panel=OF_STORE)
    ] = None
    until: Annotated[str | None, typer.Option(help="Only readings before this time.", rich_help_panel=OF_STORE)] = None

    @property
    def typed(self) -> Mapping[str, str]:
        """Options to what was typed."""
        return {f"--{name}": value for name, value in vars(self).items() if value is not None}


@dataclass(frozen=True)
class Tables:
    """Tables of objects and of readings."""

    csv: Annotated[
        Path | None, typer.Option(help="Table of objects, a column for each property.", rich_help_panel=OF_TABLES)
    ] = None
    csv_readings: Annotated[
        Path | None, typer.Option(help="Table of readings: object, action, outcome.", rich_help_panel=OF_TABLES)
    ] = None
    column: Annotated[
        list[str] | None,
        typer.Option(
            help="COLUMN='PROPERTY [UNIT]', or COLUMN= to leave it out; may be repeated.", rich_help_panel=OF_TABLES
        ),
    ] = None


@dataclass(frozen=True)
class How:
    """How a network is fitted, and scored."""

    pseudo_count: Annotated[float, typer.Option(help="Added to each count of a table.", rich_help_panel=HOW)] = 0.2
    folds: Annotated[
        int, typer.Option(help="Of the objects, to score the fit on those held out; 0: none.", rich_help_panel=HOW)
    ] = 10
    date: Annotated[
        str | None, typer.Option(help="Of the network (default: that of the last recording).", rich_help_panel=HOW)
    ] = None
