"""A squeeze: stress over strain with the fitted line; where the contact area is not known, force over the gap."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from palpate.estimators.hinge import Hinge, fit_hinge
from palpate.estimators.signals import samples
from palpate.estimators.squeezing import Jaws, squeeze
from palpate.outcomes import Above, Failed
from palpate.server.plots.drawing import number
from palpate.server.plots.plot import Curve, Look, Numbers, Plot
from palpate.store.records import Series, Setup

__all__ = [
    "MM",
    "NEWTON",
    "FoundSqueeze",
    "Held",
    "held_by",
    "may_be_squeeze",
    "squeeze_of",
    "squeeze_plot",
    "squeeze_words",
]

GAP_SD_MM = 0.1
"""Of the jaws of a gripper, where nothing more is known."""
LIMIT_KPA, DRAWN_KPA = Jaws(1.0).limit_kpa, 1e5
"""What a gripper can tell at most; a line is drawn also above it."""
STEPS = ("gap_step_mm", "count_mm")
"""Parameters of a gripper that tell in which steps its position comes."""

MM: Mapping[str, float] = {"mm": 1.0, "cm": 10.0, "m": 1e3, "um": 1e-3, "µm": 1e-3}
NEWTON: Mapping[str, float] = {"N": 1.0, "kN": 1e3, "mN": 1e-3}
"""Factors to mm and N: a few, as a unit may be any text, and asking what it means may take long."""


@dataclass(frozen=True)
class Held:
    """What a recording tells of how an object was held; None where it does not."""

    area_mm2: float | None = None
    width_mm: float | None = None
    gap_sd_mm: float = GAP_SD_MM


def held_by(setup: Setup, grasp: object) -> Held:
    """From the grasp of a recording, and the parameters of its gripper.

    Examples
    --------
    >>> held_by(Setup(), {"contact_area_mm2": 500.0, "rest_width_mm": 40.0})
    Held(area_mm2=500.0, width_mm=40.0, gap_sd_mm=0.1)
    """
    told: Mapping[str, Any] = grasp if isinstance(grasp, Mapping) else {}
    gripper: Mapping[str, Any] = {} if setup.gripper is None else setup.gripper.parameters
    area = _positive(told.get("contact_area_mm2")) or _positive(gripper.get("contact_area_mm2"))
    step = next((found for name in STEPS if (found := _positive(gripper.get(name)))), None)
    return Held(area, _positive(told.get("rest_width_mm")), GAP_SD_MM if step is None else step / 12**0.5)


def _positive(value: object) -> float | None:
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    return float(value) if is_number and 0 < value < np.inf else None  # type: ignore[arg-type,operator]


@dataclass(frozen=True)
class FoundSqueeze:
    """Gap [mm] and force [N] of a squeeze, (n), and the line through them.

    Attributes
    ----------
    hinge
        None where no line could be fitted.
    held
        What is known of area and width.
    flaw
        Why there is no line, or why it is not trusted; empty where it is.
    missing
        How many samples were left out, as gap or force is no number.
    """

    gap_mm: Numbers
    force_n: Numbers
    hinge: Hinge | None
    held: Held
    flaw: str = ""
    missing: int = 0

    @property
    def width_mm(self) -> float | None:
        """At rest: as it is known, or else the gap at contact."""
        return self.held.width_mm or (None if self.hinge is None else self.hinge.contact)

    @property
    def indentation_mm(self) -> Numbers | None:
        """How far the jaws are beyond the contact [mm], (n)."""
        return None if self.hinge is None else self.hinge.contact - self.gap_mm

    @property
    def added_n(self) -> Numbers:
        """Force beyond that of the empty jaws [N], (n)."""
        return self.force_n - (0.0 if self.hinge is None else self.hinge.idle_force)

    @property
    def is_stress(self) -> bool:
        """Whether stress and strain can be told."""
        return self.held.area_mm2 is not None and self.hinge is not None and (self.width_mm or 0.0) > 0

    @property
    def modulus_kpa(self) -> float | None:
        """The slope of stress over strain [kPa]."""
        if not self.is_stress or self.hinge is None or self.held.area_mm2 is None or self.width_mm is None:
            return None
        return 1e3 * self.hinge.slope * self.width_mm / self.held.area_mm2


def squeeze_of(series: Series, held: Held) -> FoundSqueeze | None:
    """Force over the gap, where a series has one channel of a length and one of a force that were sampled together.

    Samples of which either is missing are left out.
    """
    gaps, forces = _in_unit(series, MM), _in_unit(series, NEWTON)
    if len(gaps) != 1 or len(forces) != 1 or len(gaps[0]) != len(forces[0]):
        return None
    is_there = np.isfinite(gaps[0]) & np.isfinite(forces[0])
    gap, force = gaps[0][is_there], forces[0][is_there]
    if not len(gap):
        return None
    return replace(_found(gap, force, held), missing=int(np.count_nonzero(~is_there)))


def may_be_squeeze(units: Iterable[str | None]) -> bool:
    """Whether a series may be a squeeze, by the units of its channels, so that none is read for nothing.

    Examples
    --------
    >>> may_be_squeeze(["mm", None, "N"]), may_be_squeeze(["mm", "A"])
    (True, False)
    """
    there = set(units)
    return not there.isdisjoint(MM) and not there.isdisjoint(NEWTON)


def _in_unit(series: Series, factors: Mapping[str, float]) -> list[Numbers]:
    """Rows of samples in the first of some units, each (n)."""
    rows = [one for one in series.channels if one.unit in factors and one.values.ndim == 1]
    # what is in that unit already stays what it is to the last bit
    return [np.asarray(one.values, dtype=np.float64) * factors[one.unit or ""] for one in rows]


def _found(gap: Numbers, force: Numbers, held: Held) -> FoundSqueeze:
    try:
        return _fitted(gap, force, held) if held.area_mm2 is None else _estimated(gap, force, held, held.area_mm2)
    except (ValueError, ArithmeticError, np.linalg.LinAlgError) as error:
        # whoever sends numbers that no fit can take must not close the page for everybody
        return FoundSqueeze(gap, force, None, held, str(error))


def _fitted(gap: Numbers, force: Numbers, held: Held) -> FoundSqueeze:
    """A line through force over the gap, where the area is not known."""
    end = int(np.argmin(gap)) + 1
    gap_mm, force_n = samples("gap_mm", gap[:end]), samples("force_n", force[:end])
    return FoundSqueeze(gap, force, fit_hinge(gap_mm, force_n, gap_sd=held.gap_sd_mm, force_sd=None), held)


def _estimated(gap: Numbers, force: Numbers, held: Held, area_mm2: float) -> FoundSqueeze:
    """By the estimator, with the line also where the modulus is above what grippers can tell."""
    jaws = Jaws(area_mm2, held.width_mm, limit_kpa=DRAWN_KPA, gap_sd_mm=held.gap_sd_mm)
    found = squeeze(gap, force, jaws)
    if isinstance(found.outcome, Above) and found.hinge is None:
        return FoundSqueeze(gap, force, None, held, _too_stiff(DRAWN_KPA))
    if not isinstance(found.outcome, Failed):
        return FoundSqueeze(gap, force, found.hinge, held)
    if isinstance(squeeze(gap, force, replace(jaws, limit_kpa=LIMIT_KPA)).outcome, Above):
        return FoundSqueeze(gap, force, None, held, _too_stiff(LIMIT_KPA))
    return FoundSqueeze(gap, force, found.hinge, held, found.outcome.reason)


def _too_stiff(limit_kpa: float) -> str:
    return f"it is above {limit_kpa:.6g} kPa, and the jaws rest on it while the force grows"


def squeeze_plot(found: FoundSqueeze) -> Plot:
    """Stress over strain, or force over the gap, with the fitted line."""
    if found.is_stress and found.hinge is not None and found.indentation_mm is not None:
        return _stress_plot(found, found.hinge, found.indentation_mm)
    curves, note = [Curve(found.gap_mm, found.force_n, "measured")], ""
    if found.hinge is not None:
        knots = _within(found.hinge.contact, found.gap_mm)
        curves.append(Curve(knots, found.hinge.at(knots), "fitted line", look=Look.FITTED))
        note = f"fitted: {number(found.hinge.slope)} N/mm, {_contact(found, found.hinge)}"
    return Plot("force [N] over the gap of the jaws [mm]", "gap [mm]", "force [N]", tuple(curves), note=note)


def _stress_plot(found: FoundSqueeze, hinge: Hinge, indentation_mm: Numbers) -> Plot:
    area_mm2, width_mm = found.held.area_mm2 or 1.0, found.width_mm or 1.0
    strain, stress_kpa = indentation_mm / width_mm, 1e3 * found.added_n / area_mm2
    knots = _within(0.0, strain)
    modulus = found.modulus_kpa or 0.0
    fitted = Curve(knots, modulus * np.maximum(0.0, knots), "fitted line", look=Look.FITTED)
    return Plot(
        "stress [kPa] over strain, which is 0 at contact",
        "strain (shortened by, over the width at rest)",
        "stress [kPa]",
        (Curve(strain, stress_kpa, "measured"), fitted),
        note=f"fitted: {number(modulus)} kPa, {_contact(found, hinge)}",
    )


def _within(contact: float, measured: Numbers) -> Numbers:
    """Where a fitted line is drawn: along what was measured, with its bend where that is within."""
    return np.unique([measured.min(), np.clip(contact, measured.min(), measured.max()), measured.max()])


def _contact(found: FoundSqueeze, hinge: Hinge) -> str:
    """Where the line begins; of a place that nothing was measured at only the side."""
    first_mm = float(found.gap_mm.max())
    if hinge.contact > first_mm:
        return f"in contact from the first sample on, at {number(first_mm)} mm"
    return f"from contact at {number(hinge.contact)} mm"


def squeeze_words(found: FoundSqueeze) -> str:
    """What was taken for known; or why it is force over the gap that is drawn; and what was left out."""
    left_out = f" Samples left out, as gap or force is missing: {found.missing}." if found.missing else ""
    return f"{_words(found)}{left_out}"


def _words(found: FoundSqueeze) -> str:
    if found.is_stress:
        width = found.width_mm or 0.0
        known = "as it is known" if found.held.width_mm else "the gap at contact, as no width is told"
        if not found.held.width_mm and width > float(found.gap_mm.max()):
            known = "where the line would begin, before the first sample, as no width is told"
        told = f"Contact area {number(found.held.area_mm2 or 0.0)} mm², width at rest {number(width)} mm ({known})."
        return f"{told} No result: {found.flaw}." if found.flaw else told
    if found.held.area_mm2 is None:
        return (
            "Stress needs the contact area, of which the recording tells nothing (contact_area_mm2 in its grasp, or "
            "among the parameters of its gripper)."
        )
    return f"No line could be fitted: {found.flaw}."
