"""A plot as a figure that one can zoom: what BokehJS makes of it in the browser, as JSON.

Bokeh is imported when the first figure is asked for: pages need none of it.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from palpate.invisible import shown
from palpate.server.plots.colours import page_colours
from palpate.server.plots.drawing import COLOURS, MOST_OF_LINE, MOST_OF_ROW, short
from palpate.server.plots.plot import Curve, Look, Plot, thinned
from palpate.server.plots.scale import Scale, spanning
from palpate.server.plots.svg import HEIGHT, LEFT, LEFT_OF_ROWS

if TYPE_CHECKING:
    from bokeh.models import ColumnDataSource
    from bokeh.models.annotations import Title
    from bokeh.models.renderers import GlyphRenderer
    from bokeh.plotting import figure

__all__ = ["figure_json"]

STRETCHES = 5_000
AXES_PX = 100
"""What axes and tools need beside the plot itself."""
Colours = Mapping[str, str]


def figure_json(plot: Plot, *, dark: bool) -> bytes:
    """The figure of a plot, as `Bokeh.embed.embed_item` takes it.

    Examples
    --------
    >>> curve = Curve(np.arange(3.0), np.array([0.0, 2.0, 1.0]), "force")
    >>> b'"Figure"' in figure_json(Plot("force over time", "time [s]", "force [N]", (curve,)), dark=False)
    True
    """
    from bokeh.embed import json_item

    colours = page_colours(dark=dark)
    found = _empty(plot)
    for curve in plot.curves:
        _add_curve(found, plot, curve, colours)
    if plot.points:
        _add_points(found, plot, colours)
    if plot.levels:
        _add_levels(found, plot, colours)
    _colour(found, colours)
    if plot.note:
        found.title = _title(plot.note, colours)
    return json.dumps(json_item(found)).encode()


def _empty(plot: Plot) -> figure:
    """Axes and tools; what was named by people is plain text and no formula, which would need MathJax."""
    from bokeh.models import FixedTicker, PlainText, Range1d
    from bokeh.plotting import figure

    across = spanning(plot.ends_across(), 0.0, 1.0, room=0.05 if plot.rows else 0.02)
    down = plot.rows[-1].bottom if plot.rows else 0.0
    up = Scale(down, 0.0, 0.0, 1.0) if plot.rows else spanning(plot.ends_up(), 0.0, 1.0)
    found = figure(
        height=round((down or HEIGHT) + AXES_PX),
        sizing_mode="stretch_width",
        x_range=Range1d(start=across.low, end=across.high),
        y_range=Range1d(start=up.low, end=up.high),
        x_axis_label=PlainText(text=short(shown(plot.across), MOST_OF_LINE)),
        tools="",
        toolbar_location="above",
        min_border_left=round(LEFT_OF_ROWS if plot.rows else LEFT),
        title=None,
    )
    _add_tools(found)
    if plot.rows:
        places = {(row.top + row.bottom) / 2: _named(row.name, row.note) for row in plot.rows}
        found.yaxis.ticker = FixedTicker(ticks=list(places))
        found.yaxis.major_label_overrides = {place: PlainText(text=shown(name)) for place, name in places.items()}
    else:
        found.yaxis.axis_label = PlainText(text=short(shown(plot.up or ""), MOST_OF_ROW))
    return found


def _title(note: str, colours: Colours) -> Title:
    from bokeh.models.annotations import Title

    return Title(
        text=shown(note), align="right", text_color=colours["faint"], text_font_style="normal", text_font_size="12px"
    )


def _named(name: str, note: str) -> str:
    told = short(name, MOST_OF_ROW)
    return f"{told}\n{note}" if note else told


def _add_tools(found: figure) -> None:
    from bokeh.models import BoxZoomTool, PanTool, ResetTool, SaveTool, WheelZoomTool

    box = BoxZoomTool()
    # the page itself is moved by the wheel, unless the key is held
    wheel = WheelZoomTool(modifiers={"ctrl": True}, description="Zoom by Ctrl and the wheel")
    save = SaveTool(description="Save as PNG", filename="plot")
    found.add_tools(PanTool(), box, wheel, ResetTool(), save)
    found.toolbar.active_drag, found.toolbar.active_scroll = box, wheel
    found.toolbar.logo = None


def _add_curve(found: figure, plot: Plot, curve: Curve, colours: Colours) -> None:
    from bokeh.models import ColumnDataSource

    x, y = thinned(curve.x, curve.y, STRETCHES)
    # what is no number is a gap
    source = ColumnDataSource({"x": np.where(np.isfinite(x), x, np.nan), "y": np.where(np.isfinite(y), y, np.nan)})
    fitted = curve.look is Look.FITTED
    colour = colours["alarm"] if fitted else colours[f"c{curve.colour % COLOURS}"]
    width = 3 if curve.look is Look.MEAN else 2 if fitted else 1.5
    line = found.line(
        "x", "y", source=source, color=colour, line_width=width, line_dash="dashed" if fitted else "solid"
    )
    if curve.look is not Look.MEAN:
        told = [(plot.across, "@x{%.5g}"), (plot.up or "", "@y{%.5g}")]
        _hover(found, line, [("", _literal(curve.name)), *((_literal(name), value) for name, value in told)])


def _add_points(found: figure, plot: Plot, colours: Colours) -> None:
    from bokeh.models import ColumnDataSource, TapTool

    columns: dict[str, Any] = {
        name: [getattr(one, name) for one in plot.points] for name in ("x", "y", "low", "high", "link")
    }
    columns["told"] = [shown(one.told) for one in plot.points]
    columns["colour"] = [colours[f"c{one.colour % COLOURS}"] for one in plot.points]
    source = ColumnDataSource(columns)
    _add_bars(found, source)
    dots = found.scatter("x", "y", source=source, color="colour", size=8, alpha=0.85, nonselection_alpha=0.85)
    found.add_tools(TapTool(renderers=[dots], visible=False))
    _hover(found, dots, [("", "@told")])


def _add_bars(found: figure, source: ColumnDataSource) -> None:
    found.segment("low", "y", "high", "y", source=source, color="colour", alpha=0.45, nonselection_alpha=0.45)


def _add_levels(found: figure, plot: Plot, colours: Colours) -> None:
    from bokeh.models import ColumnDataSource

    source = ColumnDataSource({"x": [one.x for one in plot.levels], "told": [shown(one.label) for one in plot.levels]})
    lines = found.vspan(x="x", source=source, line_color=colours["true"], line_width=2, line_dash="dashed")
    if any(one.label for one in plot.levels):
        _hover(found, lines, [("", "@told")])


def _hover(found: figure, of: GlyphRenderer[Any], told: list[tuple[str, str]]) -> None:
    from bokeh.models import HoverTool

    tool = HoverTool(renderers=[of], tooltips=told, formatters={"@x": "printf", "@y": "printf"}, visible=False)
    found.add_tools(tool)


def _literal(text: str) -> str:
    """Words in which no sign stands for a column."""
    return shown(text).replace("@", "@ ").replace("$", "$ ")


def _colour(found: figure, colours: Colours) -> None:
    found.background_fill_color = found.border_fill_color = None
    found.outline_line_color = None
    for axis in (*found.xaxis, *found.yaxis):
        axis.axis_label_text_color = axis.major_label_text_color = colours["faint"]
        axis.axis_line_color = axis.major_tick_line_color = axis.minor_tick_line_color = colours["faint"]
        axis.axis_label_text_font_style = "normal"
        axis.axis_label_text_font_size = axis.major_label_text_font_size = "12px"
    found.grid.grid_line_color = colours["line"]
