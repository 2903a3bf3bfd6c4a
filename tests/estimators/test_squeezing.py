"""Squeezing: laws of the estimate, and what it refuses."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.estimators.signals import EstimatorError
from palpate.estimators.squeezing import ForceCalibration, Jaws, squeeze
from palpate.outcomes import Above, Failed, Reading

AREA_MM2, WIDTH_MM, STEP_MM = 1500.0, 55.0, 0.37


def closing(
    modulus_kpa: float,
    rng: np.random.Generator,
    *,
    noise_n: float = 0.3,
    step_mm: float = STEP_MM,
    count: int = 150,
    most_n: float = 60.0,
    idle_n: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Gap and force of jaws that close on a linear spring until their force is reached."""
    stiffness = modulus_kpa * 1e-3 * AREA_MM2 / WIDTH_MM
    gap = np.linspace(75.0, max(WIDTH_MM - most_n / stiffness, 2.0), count)
    force = stiffness * np.clip(WIDTH_MM - gap, 0, None) + idle_n
    read = np.round(gap / step_mm) * step_mm if step_mm else gap
    return read, force + rng.normal(0, noise_n, count)


@given(st.floats(1.0, 94.0), st.floats(30.0, 70.0), st.floats(100.0, 5000.0), st.floats(-2.0, 2.0))
def test_without_noise_the_modulus_is_exact(modulus: float, width: float, area: float, idle: float) -> None:
    """F = E A / L x compression gives back E, whatever the width, the area and the force of the empty jaws."""
    stiffness = modulus * 1e-3 * area / width
    gap = np.linspace(80.0, width - 10, 120)
    force = idle + stiffness * np.clip(width - gap, 0, None)
    found = squeeze(gap, force, Jaws(area, width, gap_sd_mm=0.0))
    assert found.modulus_kpa == pytest.approx(modulus, rel=1e-4)
    assert found.hinge is not None
    assert found.hinge.contact == pytest.approx(width, rel=1e-4)


@pytest.mark.parametrize("modulus", [5.0, 10.0, 20.0, 40.0, 60.0, 80.0, 92.0])
def test_steps_and_noise_cost_little(modulus: float) -> None:
    """With steps of 0.37 mm and a noise of 0.3 N the modulus is right within 2 %, and its SD below 2 kPa."""
    rng = np.random.default_rng(int(modulus))
    found = np.array([squeeze(*closing(modulus, rng), Jaws(AREA_MM2, WIDTH_MM)).modulus_kpa for _ in range(40)])
    assert found.mean() == pytest.approx(modulus, rel=0.02)
    assert found.std() < 2.0


def test_contact_is_found_where_a_threshold_on_force_is_not() -> None:
    """On a soft object a threshold of 1 N is some millimetres late; the hinge is not."""
    gap, force = closing(5.0, np.random.default_rng(1))
    found = squeeze(gap, force, Jaws(AREA_MM2, None))
    late_mm = WIDTH_MM - gap[int(np.argmax(force > 1.0))]
    assert late_mm > 3.0
    assert found.hinge is not None
    assert abs(found.hinge.contact - WIDTH_MM) < 0.5


@pytest.mark.parametrize("modulus", [97.0, 150.0, 1e3, 1e5])
def test_stiff_objects_are_above_the_limit(modulus: float) -> None:
    """Beyond what the gripper can tell, all that is said is above: also where the jaws rest on what does not yield."""
    rng = np.random.default_rng(2)
    for _ in range(20):
        gap, force = closing(modulus, rng)
        if modulus >= 1e3:
            gap, force = np.append(gap, np.full(30, gap[-1])), np.append(force, np.linspace(60, 80, 30))
        assert squeeze(gap, force, Jaws(AREA_MM2, WIDTH_MM)).outcome == Above(95.0, unit="kPa")


def test_uncertain_areas_make_the_sd_larger() -> None:
    """What no squeeze can tell is part of the SD."""
    gap, force = closing(40.0, np.random.default_rng(3))
    found = squeeze(gap, force, Jaws(AREA_MM2, WIDTH_MM, relative_sd=0.1))
    assert found.sd_kpa == pytest.approx(0.1 * found.modulus_kpa, rel=0.05)


def test_opening_again_does_not_count() -> None:
    """Where the jaws open again the force is another (hysteresis), and is left out."""
    gap, force = closing(40.0, np.random.default_rng(4), step_mm=0.0)
    both = squeeze(np.append(gap, gap[-2::-1]), np.append(force, 0.5 * force[-2::-1]), Jaws(AREA_MM2, WIDTH_MM))
    assert both.modulus_kpa == pytest.approx(40.0, rel=0.02)


def test_noise_alone_is_no_contact() -> None:
    """Noise in force, with the jaws closing or not, never gives a modulus."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        for gap in (np.linspace(85, 5, 120), 40 + rng.normal(0, 0.2, 120)):
            assert isinstance(squeeze(gap, rng.normal(0, 1, 120), Jaws(AREA_MM2, WIDTH_MM)).outcome, Failed)


@pytest.mark.parametrize(
    ("gap_mm", "force_n", "told"),
    [
        ([], [], "0 samples"),
        (np.linspace(80, 40, 50), np.full(50, 0.2), "no contact, or the sensor is silent"),
        (np.full(50, 40.0), np.linspace(0, 1, 50), "did not move"),
        (np.linspace(80, 40, 50), np.full(50, np.nan), "not finite"),
        (np.linspace(40, 80, 50), np.linspace(5, 0, 50), "the jaws close during 1 samples"),
    ],
)
def test_bad_signals_fail_with_the_reason(gap_mm: np.ndarray, force_n: np.ndarray, told: str) -> None:
    """Signals that cannot be right give a failed outcome that says why."""
    outcome = squeeze(gap_mm, force_n, Jaws(AREA_MM2, WIDTH_MM)).outcome
    assert isinstance(outcome, Failed)
    assert told in outcome.reason


def test_slip_fails() -> None:
    """A force that falls while the jaws close is a slip."""
    rng = np.random.default_rng(6)
    gap, force = closing(20.0, rng)
    force[110:] *= 0.2
    outcome = squeeze(gap, force, Jaws(AREA_MM2, WIDTH_MM)).outcome
    assert isinstance(outcome, Failed)
    assert outcome.reason.startswith("slip")


@pytest.mark.parametrize("after", [8, 15, 40])
def test_an_early_slip_is_no_missing_contact(after: int) -> None:
    """An object that pops out soon after it was touched slipped, and was touched."""
    rng = np.random.default_rng(9)
    gap, force = closing(40.0, rng)
    slips_at = int(np.argmax(gap < WIDTH_MM)) + after
    force[slips_at:] = rng.normal(0, 0.3, force.size - slips_at)
    outcome = squeeze(gap, force, Jaws(AREA_MM2, WIDTH_MM)).outcome
    assert isinstance(outcome, Failed)
    assert outcome.reason.startswith("slip")


def test_noise_is_no_slip() -> None:
    """Jaws that close on nothing did not lose anything."""
    rng = np.random.default_rng(10)
    for _ in range(50):
        outcome = squeeze(np.linspace(80, 40, 120), rng.normal(0, 0.3, 120), Jaws(AREA_MM2, WIDTH_MM)).outcome
        assert isinstance(outcome, Failed)
        assert outcome.reason.startswith("no contact")


def test_wrong_calls_are_errors() -> None:
    """Signals of two lengths, tables and areas below zero are errors and no outcomes."""
    with pytest.raises(EstimatorError, match="different lengths"):
        squeeze(np.linspace(80, 40, 50), np.linspace(0, 1, 49), Jaws(AREA_MM2))
    with pytest.raises(EstimatorError, match="expected \\(n,\\)"):
        squeeze(np.zeros((5, 5)), np.zeros(5), Jaws(AREA_MM2))
    with pytest.raises(EstimatorError, match="area_mm2"):
        Jaws(-1.0)


def test_current_stands_for_force() -> None:
    """With a calibration a squeeze may be read from the motor's current."""
    gap, force = closing(30.0, np.random.default_rng(7))
    current = 0.05 + force / 80.0
    found = squeeze(gap, ForceCalibration(80.0, 0.05).force_n(current), Jaws(AREA_MM2, WIDTH_MM))
    assert isinstance(found.outcome, Reading)
    assert found.modulus_kpa == pytest.approx(30.0, rel=0.02)


def test_fingers_that_meet_are_no_object() -> None:
    """A missed grasp closes on the other finger's pad: neither stiff where the width is known, nor soft where not."""
    gap = 85 - np.round(np.linspace(0, 85, 230) / STEP_MM) * STEP_MM
    force = 30 * np.maximum(0, 2 - np.linspace(85, 0, 230)) + np.random.default_rng(30).normal(0, 0.15, 230)
    for width_mm in (WIDTH_MM, None):
        outcome = squeeze(gap, force, Jaws(AREA_MM2, width_mm)).outcome
        assert isinstance(outcome, Failed)
        assert "where the jaws meet" in outcome.reason


@pytest.mark.parametrize("scale", [1e-3, 0.1, 10.0])
def test_a_gap_in_other_units_is_no_contact(scale: float) -> None:
    """Jaws that touch at a gap that is not the known width touch something else, or tell the gap in other units."""
    gap, force = closing(30.0, np.random.default_rng(31))
    assert isinstance(squeeze(gap, force, Jaws(AREA_MM2, WIDTH_MM)).outcome, Reading)
    assert isinstance(squeeze(scale * gap, force, Jaws(AREA_MM2, WIDTH_MM)).outcome, Failed)


def test_a_force_that_only_drifts_is_no_contact() -> None:
    """A zero that wanders evenly while the jaws close in the air grows like a force, from the first sample on."""
    gap = np.linspace(75, 45, 150)
    for seed in range(20):
        force = 0.01 * np.arange(150) + np.random.default_rng(seed).normal(0, 0.15, 150)
        for width_mm in (WIDTH_MM, None):
            assert isinstance(squeeze(gap, force, Jaws(AREA_MM2, width_mm)).outcome, Failed)


def test_a_soft_object_is_felt_where_its_width_is_known() -> None:
    """A sponge of a newton in all bends its line so little that noise hides it, and is measured nonetheless."""
    gap, rng, sds = np.linspace(62, 40, 80), np.random.default_rng(33), []
    for _ in range(60):
        force = 0.14 * np.maximum(0, WIDTH_MM - gap) + rng.normal(0, 0.15, 80)
        found = squeeze(gap, force, Jaws(AREA_MM2, WIDTH_MM))
        if isinstance(found.outcome, Reading):
            sds.append((found.modulus_kpa - 0.14 * 1e3 * WIDTH_MM / AREA_MM2) / found.sd_kpa)
    assert len(sds) >= 57
    assert 0.7 < np.std(sds) < 1.3


@pytest.mark.parametrize("most_n", [4.0, 5.0, 6.0, 7.0])
@pytest.mark.parametrize("noise_n", [0.0, 0.05])
def test_a_force_that_stops_growing_fails(most_n: float, noise_n: float) -> None:
    """A sensor at its end would make the object softer than it is, be there noise on top or not."""
    gap, rng = np.linspace(75, 45, 150), np.random.default_rng(32)
    force = np.minimum(0.9 * np.maximum(0, WIDTH_MM - gap) + rng.normal(0, 0.15 * (noise_n == 0), 150), most_n)
    read = 85 - np.round((85 - gap) / STEP_MM) * STEP_MM
    assert isinstance(squeeze(read, force + rng.normal(0, noise_n, 150), Jaws(AREA_MM2, WIDTH_MM)).outcome, Failed)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [("gap_sd_mm", -1.0), ("relative_sd", float("nan")), ("width_mm", float("inf")), ("force_sd_n", 0.0)],
)
def test_jaws_that_cannot_be_are_errors(name: str, wrong: float) -> None:
    """An SD or a width that is no such thing is said at once, and makes no number."""
    with pytest.raises(EstimatorError, match=name):
        Jaws(AREA_MM2, **{name: wrong})
