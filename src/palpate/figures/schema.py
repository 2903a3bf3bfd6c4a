"""A picture of the tables of a store: their columns, and which refer to which."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sqlalchemy import Column, ForeignKey, Table

from palpate.figures.palette import BLUE, GREY, INK, PALE
from palpate.store import schema

if TYPE_CHECKING:
    from matplotlib.axes import Axes

__all__ = ["draw_schema", "fingerprint"]

PLACES = (
    ("thing_properties", "thing_images", "audit", "properties"),
    ("things", "descriptions", "episodes", "users"),
    ("recordings", "episode_steps", "senders", "tokens"),
    ("series", "files", "entries"),
    ("layouts", "setups", "setup_devices", "devices"),
)
"""The tables of each column of the picture, from the top."""

ROW, WIDTH, GAP, BETWEEN = 1.0, 15.0, 7.0, 2.2
KINDS: Mapping[str, str] = {"BIGINT": "integer", "VARCHAR": "text", "BLOB": "bytes", "FLOAT": "number"}


@dataclass(frozen=True)
class Box:
    """Where a table stands: its left upper corner."""

    table: Table
    x: float
    y: float

    @property
    def height(self) -> float:
        """With the row of its name."""
        return ROW * (len(self.table.columns) + 1.4)

    def row(self, name: str) -> float:
        """The middle of a column's row."""
        place = [column.name for column in self.table.columns].index(name)
        return self.y - ROW * (place + 1.9)


def draw_schema(path: str | Path) -> None:
    """Draw all tables; bold columns tell rows apart, arrows lead from a column to the table that it refers to.

    Dotted arrows repeat for queries what a recording refers to already.

    Parameters
    ----------
    path
        Where to write; the suffix gives the format (png, svg, pdf).
    """
    from matplotlib.figure import Figure

    boxes = {box.table.name: box for box in _boxes()}
    right = max(box.x for box in boxes.values()) + WIDTH
    bottom = min(box.y - box.height for box in boxes.values())
    figure = Figure(figsize=(right / 7.2, -bottom / 6.0))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    axes.set_xlim(-2.0, right + 2.0)
    axes.set_ylim(bottom - 1.0, 1.0)
    for box in boxes.values():
        _draw_box(axes, box)
        for column in box.table.columns:
            for key in column.foreign_keys:
                _draw_arrow(axes, box, column, boxes[key.column.table.name])
    told: dict[str, str] = {"Description": fingerprint()} if Path(path).suffix.lower() == ".png" else {}
    figure.savefig(path, dpi=110, metadata=told or None)


def fingerprint() -> str:
    """What the picture shows, in short: it changes when a table does."""
    lines = [
        f"{table.name}.{column.name} {column.type} {column.nullable} {sorted(map(_target, column.foreign_keys))}"
        for table in schema.metadata.sorted_tables
        for column in table.columns
    ]
    return sha256("\n".join(lines).encode()).hexdigest()


def _target(key: ForeignKey) -> str:
    return key.target_fullname


def _boxes() -> Iterator[Box]:
    for place, names in enumerate(PLACES):
        y = 0.0
        for name in names:
            box = Box(schema.metadata.tables[name], place * (WIDTH + GAP), y)
            yield box
            y -= box.height + BETWEEN


def _draw_box(axes: Axes, box: Box) -> None:
    from matplotlib.patches import Rectangle

    edge: dict[str, Any] = {"edgecolor": GREY, "linewidth": 0.8, "zorder": 2}
    axes.add_patch(Rectangle((box.x, box.y - box.height), WIDTH, box.height, facecolor="white", **edge))
    axes.add_patch(Rectangle((box.x, box.y - 1.4 * ROW), WIDTH, 1.4 * ROW, facecolor=PALE, **edge))
    text: dict[str, Any] = {"va": "center", "zorder": 3}
    axes.text(box.x + 0.5, box.y - 0.7 * ROW, box.table.name, color=BLUE, fontsize=9.5, weight="bold", **text)
    for column in box.table.columns:
        weight = "bold" if column.primary_key else "normal"
        y = box.row(column.name)
        axes.text(box.x + 0.5, y, column.name, color=INK, fontsize=7.5, weight=weight, **text)
        axes.text(box.x + WIDTH - 0.5, y, _kind(column), color=GREY, fontsize=6.5, ha="right", **text)


def _kind(column: Column[Any]) -> str:
    kind = str(column.type).partition("(")[0]
    return KINDS.get(kind, kind.lower()) + ("" if not column.nullable else ", or none")


def _draw_arrow(axes: Axes, box: Box, column: Column[Any], other: Box) -> None:
    """From the row of a column to the name of a table, on the sides that face each other."""
    start, end = box.row(column.name), other.y - 0.7 * ROW
    if box.x < other.x:
        ends = (box.x + WIDTH, start), (other.x, end)
    elif box.x > other.x:
        ends = (box.x, start), (other.x + WIDTH, end)
    else:
        ends = (box.x, start), (other.x, end)
    below = 1 if end < start else -1
    bend = 0.0 if box.x != other.x else 0.5 * below
    # what a recording says too, and is repeated for queries
    repeats = "recording_id" in box.table.columns and column.name in schema.recordings.columns
    arrow: dict[str, Any] = {"arrowstyle": "-|>", "color": GREY, "lw": 0.9, "shrinkA": 0, "shrinkB": 0}
    arrow |= {"connectionstyle": f"arc3,rad={bend}", "linestyle": ":" if repeats else "-"}
    axes.annotate("", ends[1], ends[0], arrowprops=arrow, zorder=1)
