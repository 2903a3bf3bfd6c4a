"""SVG, piece by piece: shapes with classes, so that style sheets give them their colours, light and dark."""

from __future__ import annotations

from collections.abc import Iterable
from math import floor, isfinite, log10

from markupsafe import Markup, escape

from palpate.invisible import shown
from palpate.server.plots.scale import Scale

__all__ = ["MOST_OF_LINE", "MOST_OF_ROW", "Drawing", "number", "short", "with_sd"]

COLOURS = 8
MOST_OF_ROW, MOST_OF_LINE = 24, 110
"""Letters that fit at the left of a row, and across a plot."""
SMALLEST_SD, LARGEST = 1e-4, 1e7
"""Beyond them numbers have a power of ten."""


def number(value: float) -> str:
    """A number with four digits at most, as people read it.

    Examples
    --------
    >>> number(1234.6), number(0.012345), number(1e-7), number(40.0)
    ('1235', '0.01235', '1e-07', '40')
    """
    return f"{value:.0f}" if 1000 <= abs(value) < 1e7 else f"{value:.4g}"


def with_sd(value: float, sd: float | None) -> str:
    """A number with its SD, which has two digits that count; the number has none beyond them.

    Examples
    --------
    >>> with_sd(45.9412, 0.7796), with_sd(118.0, 2.0), with_sd(1234.6, 567.0), with_sd(9.7, None)
    ('45.94 ± 0.78', '118 ± 2', '1230 ± 570', '9.7')
    """
    if sd is None:
        return number(value)
    if not (isfinite(value) and SMALLEST_SD <= sd < LARGEST and abs(value) < LARGEST):
        return f"{number(value)} ± {sd:.2g}"
    digits = 1 - floor(log10(float(f"{sd:.1e}")))
    told = [f"{round(one, digits):.{max(0, digits)}f}" for one in (value, sd)]
    while "." in told[0] and all(one.endswith(("0", ".")) for one in told):
        told = [one[:-1] for one in told]
    return " ± ".join(told)


def short(name: str, most: int) -> str:
    """A text that fits where there is room for so many letters.

    Examples
    --------
    >>> short("a gripper with a name that is long", 26)
    'a gripper with a name tha…'
    """
    return name if len(name) <= most else name[: most - 1] + "…"


class Drawing:
    """An SVG picture that grows.

    Parameters
    ----------
    width, height
        In its own units; on the page it is as wide as there is room.
    title
        What there is to see, for those who cannot.
    """

    def __init__(self, width: float, height: float, title: str) -> None:
        self.width, self.height, self.title = width, height, title
        # f-strings, as there may be hundreds of points: filling in a `Markup` takes ten times as long
        self._parts: list[str] = []

    def markup(self) -> Markup:
        """The picture, to stand in a page."""
        title, box, body = escape(shown(self.title)), f"0 0 {self.width} {self.height}", "".join(self._parts)
        # what is within a picture is hidden from who does not see it, and links must not be
        role = "group" if "<a " in body else "img"
        head = f'<svg class="plot" viewBox="{box}" role="{role}" aria-label="{title}"><title>{title}</title>'
        return Markup(f"{head}{body}</svg>")

    def line(self, x1: float, y1: float, x2: float, y2: float, kind: str, told: str = "") -> None:
        """A line, which may say what it is."""
        head = f'<line x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}" class="{escape(kind)}"'
        self._parts.append(f"{head}><title>{escape(shown(told))}</title></line>" if told else f"{head}/>")

    def rectangle(self, x: float, y: float, width: float, height: float, kind: str) -> None:
        """A rectangle."""
        size = f'width="{round(max(0.0, width), 2)}" height="{round(max(0.0, height), 2)}"'
        self._parts.append(f'<rect x="{x}" y="{y}" {size} class="{escape(kind)}"/>')

    def dot(self, x: float, y: float, kind: str, told: str, link: str | None = None) -> None:
        """A dot that says what it is, and leads somewhere."""
        head = f'<circle cx="{x}" cy="{y}" r="3.5" class="dot {escape(kind)}">'
        shape = f"{head}<title>{escape(shown(told))}</title></circle>"
        self._parts.append(shape if link is None else f'<a href="{escape(link)}">{shape}</a>')

    def curve(self, points: Iterable[tuple[float, float]], kind: str) -> None:
        """A line through points."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self._parts.append(f'<polyline points="{path}" class="{escape(kind)}"/>')

    def area(self, points: Iterable[tuple[float, float]], kind: str) -> None:
        """A surface within a line that comes back to where it began."""
        path = " ".join(f"{x:g},{y:g}" for x, y in points)
        self._parts.append(f'<polygon points="{path}" class="{escape(kind)}"/>')

    def image(self, x: float, y: float, width: float, height: float, address: str) -> None:
        """A picture of this site, stretched to fill a rectangle."""
        place = f'x="{x}" y="{y}" width="{width}" height="{height}" preserveAspectRatio="none"'
        self._parts.append(f'<image href="{escape(address)}" {place}/>')

    def text(
        self, x: float, y: float, words: str, kind: str = "", anchor: str = "start", most: int = MOST_OF_LINE
    ) -> None:
        """Words; of more than fit the beginning, with all of them in a title."""
        whole = shown(words)
        told = short(whole, most)
        title = f"<title>{escape(whole)}</title>" if told != whole else ""
        head = f'<text x="{x}" y="{y}" class="{escape(kind)}" text-anchor="{escape(anchor)}">'
        self._parts.append(f"{head}{escape(told)}{title}</text>")

    def across_axis(self, across: Scale, top: float, bottom: float, label: str) -> None:
        """Ticks below, lines up from them, and what it is."""
        for value in across.ticks():
            self.line(across.at(value), top, across.at(value), bottom, "grid")
            self.text(across.at(value), bottom + 16, number(value), "tick", "middle")
        self.line(across.start, bottom, across.end, bottom, "axis")
        self.text((across.start + across.end) / 2, bottom + 33, label, "label", "middle")

    def up_axis(self, up: Scale, left: float, right: float, label: str) -> None:
        """Ticks at the left, lines across from them, and what it is."""
        for value in up.ticks(4):
            self.line(left, up.at(value), right, up.at(value), "grid")
            self.text(left - 6, up.at(value) + 4, number(value), "tick", "end")
        self.text(left, up.end - 8, label, "label", "start")
