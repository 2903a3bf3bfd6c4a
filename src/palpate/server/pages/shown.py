"""Plots in pages: a picture that is there at once, and the address of the figure that one can zoom."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from fastapi import Query
from fastapi.responses import Response
from markupsafe import Markup

from palpate.server.plots.interactive import figure_json
from palpate.server.plots.plot import Plot
from palpate.server.plots.svg import svg
from palpate.server.problems import problem

__all__ = ["Dark", "Shown", "figure", "shown"]

Dark = Annotated[bool, Query(description="In the colours of the dark page.")]


@dataclass(frozen=True)
class Shown:
    """A plot as a page has it."""

    picture: Markup
    figure: str


def shown(plot: Plot | None, figure: str) -> Shown | None:
    """A plot with the address of its figure; None where there is no plot."""
    return None if plot is None else Shown(svg(plot), figure)


def figure(plot: Plot | None, *, dark: bool) -> Response:
    """The answer at that address."""
    if plot is None:
        raise problem(404, "plot: there is none, or none that you may see")
    return Response(figure_json(plot, dark=dark), media_type="application/json")
