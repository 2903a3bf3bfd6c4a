"""`palpate episode`: what can be done with the log of an exploration."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

app = typer.Typer(help="Draw the log of an exploration.")


@app.callback()
def episode() -> None:
    """Draw the log of an exploration."""


@app.command("plot")
def plot(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="What palpate explore --log wrote.")],
    picture: Annotated[Path, typer.Argument(metavar="PICTURE", help="The file to draw: .png, .svg or .pdf.")],
) -> None:
    """Draw an episode from its log: gains over the steps, actions taken, belief before and after."""
    from palpate.cli.files import check_picture, replacing
    from palpate.episode import read_episode
    from palpate.figures.episode import draw_episode

    check_picture("PICTURE", picture)
    found = read_episode(log)
    with replacing(picture) as draft:
        draw_episode(found, draft)
