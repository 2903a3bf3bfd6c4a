"""Options of `palpate calibrate`, for `palpate.cli.spreading.spread`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from palpate.cli.task_options import WHAT, RobotKind, Seed

__all__ = ["Measured"]


@dataclass(frozen=True)
class Measured:
    """Who measures what, and how often."""

    robot: Annotated[
        RobotKind | None,
        typer.Option(
            help="Who measures: the bench in physics, or draws from a network (default: recordings of a store).",
            rich_help_panel=WHAT,
        ),
    ] = None
    world: Annotated[
        str | None,
        typer.Option(
            metavar="NETWORK",
            help="From whose sensors the sampled robot draws (default: --like).",
            rich_help_panel=WHAT,
        ),
    ] = None
    thing: Annotated[
        list[str] | None,
        typer.Option("--object", help="An object to measure; repeatable (default: all known).", rich_help_panel=WHAT),
    ] = None
    action: Annotated[
        list[str] | None,
        typer.Option(help="An action to calibrate; repeatable (default: all).", rich_help_panel=WHAT),
    ] = None
    times: Annotated[
        int, typer.Option(min=1, help="How often each action is done on each object.", rich_help_panel=WHAT)
    ] = 20
    seed: Seed = 0

    @property
    def things(self) -> tuple[str, ...]:
        """The objects that were named."""
        return tuple(self.thing or ())

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that were named."""
        return tuple(self.action or ())
