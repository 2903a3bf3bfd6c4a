"""`palpate explore`: explore one object and show every step."""

from __future__ import annotations

from typing import Annotated

import typer

from palpate.cli.asked import Asked
from palpate.cli.spreading import spread
from palpate.cli.store_options import Place

__all__ = ["explore"]


@spread
def explore(
    asked: Asked,
    place: Place,
    list_objects: Annotated[bool, typer.Option("--list", help="List the objects and exit.")] = False,
) -> None:
    """Explore an object: choose the most informative action, do it, update the belief, until enough is known."""
    from palpate.cli import exploring

    if list_objects:
        exploring.list_objects(asked)
    else:
        exploring.explore_object(asked, place)
