"""Several recordings of one object in one plot, so that what measured them can be compared."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from uuid import UUID

from palpate.server.plots.plot import Curve, Numbers, Plot
from palpate.server.plots.squeezes import FoundSqueeze

__all__ = ["Laid", "Overlay", "overlay"]


@dataclass(frozen=True)
class Laid:
    """A recording with a name and the colour of its device; its squeeze, or else its first channel, as a plot.

    `too_large` is its id where some of its series were too large to be read, and neither was found in the others.
    """

    name: str
    colour: int
    squeeze: FoundSqueeze | None
    channel: Plot | None
    too_large: UUID | None = None


@dataclass(frozen=True)
class Overlay:
    """The plot, None where no two things to draw are of a kind; in words what it is; and who is not in it."""

    plot: Plot | None
    words: str
    left_out: tuple[str, ...]


def overlay(laid: Sequence[Laid]) -> Overlay:
    """Lay recordings over each other: squeezes with their contacts at 0, other signals over time."""
    squeezes = [(one, one.squeeze) for one in laid if one.squeeze is not None and one.squeeze.hinge is not None]
    return _squeezes(laid, squeezes) if squeezes else _channels(laid)


def _squeezes(laid: Sequence[Laid], found: Sequence[tuple[Laid, FoundSqueeze]]) -> Overlay:
    is_stress = all(squeeze.is_stress for _, squeeze in found)
    curves = tuple(Curve(*_aligned(squeeze, is_stress=is_stress), one.name, one.colour) for one, squeeze in found)
    across, up = ("strain", "stress [kPa]") if is_stress else ("beyond contact [mm]", "force [N]")
    words = "Contact, where the fitted line begins, is at 0; what is left of it was measured before contact."
    if not is_stress:
        words += " Force, not stress, as the contact area is not known of all."
    plot = Plot(f"{up} over {across} of {len(curves)} squeezes", across, up, curves)
    drawn = {one.name for one, _ in found}
    return Overlay(plot, words, tuple(one.name for one in laid if one.name not in drawn))


def _aligned(squeeze: FoundSqueeze, *, is_stress: bool) -> tuple[Numbers, Numbers]:
    if squeeze.indentation_mm is None:
        raise AssertionError("a squeeze with a line has a contact")
    if not is_stress:
        return squeeze.indentation_mm, squeeze.added_n
    return squeeze.indentation_mm / (squeeze.width_mm or 1.0), 1e3 * squeeze.added_n / (squeeze.held.area_mm2 or 1.0)


def _channels(laid: Sequence[Laid]) -> Overlay:
    """The first channel of each, where it is in the unit of the first recording's."""
    found = [(one, one.channel) for one in laid if one.channel is not None]
    if not found:
        return Overlay(None, "These recordings hold no curves.", tuple(one.name for one in laid))
    first = found[0][1]
    same = [(one, plot) for one, plot in found if (_unit(plot), plot.across) == (_unit(first), first.across)]
    curves = tuple(Curve(plot.curves[0].x, plot.curves[0].y, one.name, one.colour) for one, plot in same)
    drawn = {one.name for one, _ in same}
    plot = Plot(f"{first.up} over {first.across} of {len(curves)} recordings", first.across, first.up, curves)
    return Overlay(plot, "Over time, from the first sample on.", tuple(o.name for o in laid if o.name not in drawn))


def _unit(plot: Plot) -> str:
    return (plot.up or "").rpartition("[")[2]
