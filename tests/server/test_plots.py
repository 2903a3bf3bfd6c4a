import base64
import gzip
import json
import re
from dataclasses import replace
from typing import Any
from uuid import uuid4

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.robots.signal_files import wav
from palpate.server.plots.curves import channel_plot
from palpate.server.plots.final_beliefs import beliefs_plot
from palpate.server.plots.interactive import figure_json
from palpate.server.plots.levels import in_lines, known_levels
from palpate.server.plots.no_squeeze import no_squeeze_words
from palpate.server.plots.overlays import Laid, overlay
from palpate.server.plots.plot import Plot
from palpate.server.plots.points import points_plot
from palpate.server.plots.scale import Scale, spanning
from palpate.server.plots.sounds import sound_in
from palpate.server.plots.spectrogram import spectrogram
from palpate.server.plots.squeezes import Held, held_by, squeeze_of, squeeze_plot, squeeze_words
from palpate.server.plots.svg import svg
from palpate.store.final_beliefs import FinalBelief
from palpate.store.records import Channel, Device, Series, Setup
from palpate.store.visible_results import Result
from tests.store.made_up import START

numbers = st.floats(-1e12, 1e12)


@given(st.lists(numbers, max_size=5))
def test_a_scale_holds_all_values_and_has_round_ticks(values: list[float]) -> None:
    """All values lie between the ends, and there are a few ticks in order between them too."""
    scale = spanning(values, 100.0, 500.0)
    assert all(100 <= scale.at(value) <= 500 for value in values)
    ticks = scale.ticks()
    assert 1 <= len(ticks) <= 8
    assert ticks == sorted(set(ticks))
    assert all(scale.low <= tick * (1 + 1e-9) and tick <= scale.high + abs(scale.high) * 1e-9 for tick in ticks)


def drawn(plot: Plot | None) -> str:
    assert plot is not None
    return str(svg(plot))


def drawn_y(channel: Channel) -> list[list[float]]:
    plot = drawn(channel_plot(channel))
    return [[float(pair.split(",")[1]) for pair in points.split()] for points in re.findall(r'points="([^"]*)"', plot)]


def test_no_peak_is_lost_and_a_gap_is_a_gap() -> None:
    """Of 100,000 samples the one that stands out is drawn, and missing ones are not bridged."""
    values = np.zeros(100_000)
    values[54_321] = 7.0
    (line,) = drawn_y(Channel("force", "force", "N", values, rate_hz=1e4))
    assert len(line) < 2_000
    assert min(line) < 60 < max(line)
    values = np.array([0.0, 1.0, np.nan, np.nan, 2.0, 3.0])
    assert [len(line) for line in drawn_y(Channel("force", "force", "N", values))] == [2, 2]


@pytest.mark.parametrize("share", [0.01, 0.5])
def test_samples_missing_here_and_there_do_not_empty_a_plot(share: float) -> None:
    """Of 100,000 positive samples some are missing: the line has no gap but where a whole stretch is missing."""
    values = 5 + np.sin(np.arange(100_000) / 5_000)
    values[np.random.default_rng(0).random(values.size) < share] = np.nan
    values[60_000:70_000] = np.nan
    lines = drawn_y(Channel("force", "force", "N", values, rate_hz=1e4))
    assert [len(line) for line in lines] == [600, 300]
    plot = channel_plot(Channel("force", "force", "N", values, rate_hz=1e4))
    assert plot is not None
    (source,) = columns(figure_json(plot, dark=False))
    missing = np.isnan(source["y"])
    assert np.flatnonzero(missing).tolist() == list(range(6_000, 7_000))


@pytest.mark.parametrize(
    "values",
    [
        np.zeros((4, 3, 3), np.uint8),
        np.zeros((4, 30)),
        np.zeros(0),
        np.zeros((0, 3)),
        np.array([True, False]),
    ],
)
def test_what_is_no_curve_is_not_drawn(values: np.ndarray) -> None:
    """Images, wide tables, nothing, and switches."""
    assert channel_plot(Channel("odd", "odd", None, values)) is None


@pytest.mark.parametrize("values", [np.full(5, np.nan), np.array([np.inf, 1.0]), np.array([1e308, -1e308]), np.ones(1)])
def test_odd_samples_can_be_drawn(values: np.ndarray) -> None:
    """Whatever numbers are there, a plot has numbers only."""
    found = channel_plot(Channel("odd", "odd", None, values))
    plot = drawn(found)
    assert not re.search(r'="[^"]*\b(nan|inf)\b', plot)
    assert found is not None
    json.loads(figure_json(found, dark=False), parse_constant=pytest.fail)


def test_the_line_through_a_squeeze_is_found() -> None:
    """A spring of 2 N/mm that begins at 50 mm is fitted as that."""
    gap = np.linspace(60, 40, 100)
    force = 2.0 * np.maximum(0.0, 50 - gap) + np.random.default_rng(1).normal(0, 0.05, 100)
    channels = Channel("position", "length", "mm", gap), Channel("force", "force", "N", force)
    found = squeeze_of(Series("gripper", channels), Held())
    assert found is not None
    assert found.hinge is not None
    assert found.hinge.slope == pytest.approx(2.0, rel=0.02)
    assert found.hinge.contact == pytest.approx(50.0, abs=0.1)
    assert squeeze_of(Series("gripper", channels[:1]), Held()) is None
    # without an area it is force over the gap, and is said why
    plot = squeeze_plot(found)
    assert (plot.across, plot.up) == ("gap [mm]", "force [N]")
    assert "contact area" in squeeze_words(found)


def spring(width_mm: float, stiffness: float) -> Series:
    gap = np.linspace(width_mm + 5, width_mm - 8, 130)
    force = 0.3 + stiffness * np.maximum(0.0, width_mm - gap) + np.random.default_rng(2).normal(0, 0.02, 130)
    return Series("gripper", (Channel("gap", "length", "mm", gap), Channel("force", "force", "N", force)))


@pytest.mark.parametrize("told_by", ["grasp", "gripper"])
def test_stress_over_strain_has_youngs_modulus_as_its_slope(told_by: str) -> None:
    """1.5 N/mm over 600 mm2 of an object of 40 mm is 100 kPa; strain is 0 at contact, stress is without idle force."""
    told = {"contact_area_mm2": 600.0}
    gripper = Device("gripper", "jaws", parameters=told if told_by == "gripper" else {})
    held = held_by(Setup(gripper=gripper), {"rest_width_mm": 40.0, **told} if told_by == "grasp" else None)
    found = squeeze_of(spring(40.0, 1.5), held)
    assert found is not None
    assert found.modulus_kpa == pytest.approx(100.0, rel=0.02)
    plot = squeeze_plot(found)
    measured, fitted = plot.curves
    assert plot.up == "stress [kPa]"
    assert measured.x[-1] == pytest.approx(8 / 40, rel=0.02)
    assert measured.y[-1] == pytest.approx(1e3 * 1.5 * 8 / 600, rel=0.03)
    assert abs(measured.y[:40]).max() < 0.2
    assert fitted.y[-1] / fitted.x[-1] == pytest.approx(found.modulus_kpa)
    # the figure that one can zoom tells it too
    assert plot.note.startswith("fitted: ")
    assert plot.note in figure_json(plot, dark=False).decode()
    assert ("as it is known" if told_by == "grasp" else "the gap at contact") in squeeze_words(found)


@pytest.mark.parametrize(("length", "to_length"), [("m", 1e-3), ("cm", 0.1)])
def test_a_squeeze_in_other_units_with_a_sample_missing_is_one(length: str, to_length: float) -> None:
    """The modulus is that of mm and N; what is missing is left out, and said."""
    gap, force = (channel.values.copy() for channel in spring(40.0, 1.5).channels)
    held = Held(area_mm2=600.0, width_mm=40.0)
    force[7] = np.nan
    channels = (
        Channel("gap", "length", length, gap * to_length),
        Channel("force", "force", "kN", force * 1e-3),
    )
    found = squeeze_of(Series("gripper", channels), held)
    assert found is not None
    assert found.modulus_kpa == pytest.approx(100.0, rel=0.02)
    assert squeeze_plot(found).curves[0].x.size == gap.size - 1
    assert "is missing: 1." in squeeze_words(found)
    whole = squeeze_of(spring(40.0, 1.5), held)
    assert whole is not None
    assert "left out" not in squeeze_words(whole)


NUMBERS = np.arange(8.0)
GAP, FORCE = Channel("gap", "position", "mm", NUMBERS, 10.0), Channel("load", "force", "N", NUMBERS, 10.0)
UNITS = "expected mm, cm, m, um, µm"


@pytest.mark.parametrize(
    ("channels", "why"),
    [
        ((replace(GAP, unit="inch"), FORCE), f"gap is in inch, {UNITS}"),
        ((replace(GAP, unit=None), FORCE), f"gap has no unit, {UNITS}"),
        ((replace(GAP, unit="dimensionless"), FORCE), f"gap is in dimensionless, {UNITS}"),
        ((GAP, replace(FORCE, unit="lbf")), "load is in lbf, expected N, kN, mN"),
        ((GAP, replace(FORCE, quantity="squeeze force", unit="lbf")), ""),
        ((GAP, replace(FORCE, values=np.ones((8, 3)))), "load has 3 numbers in each sample, expected one"),
        ((GAP, replace(FORCE, values=np.ones((0, 3)))), "load has 3 numbers in each sample, expected one"),
        ((GAP, replace(FORCE, values=NUMBERS[:5])), "gap has 8 samples and load 5, expected as many, taken together"),
        ((GAP, replace(FORCE, values=np.full(8, np.nan))), "no sample has both gap and load"),
        (
            (GAP, FORCE, replace(GAP, name="finger 2")),
            "gap and finger 2 may each be the gap, expected one in the series",
        ),
        ((GAP, FORCE, replace(FORCE, name="z")), "load and z may each be the force, expected one in the series"),
        ((GAP,), ""),
        ((FORCE, Channel("arm", "torque", "N*m", NUMBERS, 10.0)), ""),
    ],
)
def test_why_something_is_no_squeeze_is_told(channels: tuple[Channel, ...], why: str) -> None:
    """Of a series with a gap and a force in one sentence, and nothing of others."""
    series = Series("gripper", channels)
    assert squeeze_of(series, Held(area_mm2=100.0)) is None
    assert no_squeeze_words(series) == (f"Stress over strain is not drawn: {why}." if why else "")


def test_a_squeeze_of_something_very_stiff_says_that_it_is() -> None:
    """Far above what can be drawn there is no line, and the reason is that."""
    found = squeeze_of(spring(40.0, 1.5e6), Held(area_mm2=600.0, width_mm=40.0))
    assert found is not None
    assert found.hinge is None
    assert "No line could be fitted: it is above 100000 kPa" in squeeze_words(found)


def test_a_squeeze_of_nothing_says_why_there_is_no_line() -> None:
    """Noise alone: force over the gap, with the reason."""
    gap, force = np.linspace(50, 40, 80), np.random.default_rng(0).normal(0, 0.1, 80)
    series = Series("gripper", (Channel("gap", "length", "mm", gap), Channel("force", "force", "N", force)))
    found = squeeze_of(series, Held(area_mm2=600.0))
    assert found is not None
    assert found.flaw
    assert found.flaw in squeeze_words(found)
    # a wall: the gap stays while the force grows
    gap, force = np.r_[np.linspace(50, 40, 60), np.full(40, 40.0)], np.r_[np.zeros(60), np.linspace(0, 30, 40)]
    wall = Series("gripper", (Channel("gap", "length", "mm", gap), Channel("force", "force", "N", force)))
    found = squeeze_of(wall, Held(area_mm2=600.0))
    assert found is not None
    assert "above 95 kPa" in squeeze_words(found)
    assert held_by(Setup(), {"contact_area_mm2": "much", "rest_width_mm": True}) == Held()


@pytest.mark.parametrize("area_mm2", [None, 100.0])
@pytest.mark.parametrize("scale", [1e308, 1e200, 1e-320])
@pytest.mark.parametrize("shape", [(1, -1), (0, 1)])
def test_forces_that_nobody_can_fit_are_drawn_without_a_line(
    shape: tuple[int, int], scale: float, area_mm2: float | None
) -> None:
    """Numbers whose squares are no numbers give a plot, and the reason why there is no line."""
    force = np.repeat(np.array(shape) * scale, 6)
    channels = (
        Channel("gap", "length", "mm", np.linspace(60, 49, 12)),
        Channel("force", "force", "N", force),
    )
    found = squeeze_of(Series("gripper", channels), Held(area_mm2=area_mm2))
    assert found is not None
    if scale > 1:
        assert found.hinge is None
        assert "expected 1e+50 at most" in found.flaw
    assert not re.search(r'="[^"]*\b(nan|inf)\b', drawn(squeeze_plot(found)))


def columns(figure: bytes) -> list[dict[str, Any]]:
    """The columns of all sources of a figure, arrays as bytes decoded."""
    found: list[dict[str, Any]] = []

    def look(part: Any) -> None:
        if isinstance(part, dict):
            if part.get("name") == "ColumnDataSource":
                entries = part["attributes"]["data"]["entries"]
                found.append({name: values(value) for name, value in entries})
            for inner in part.values():
                look(inner)
        elif isinstance(part, list):
            for inner in part:
                look(inner)

    def values(value: Any) -> Any:
        if isinstance(value, dict):
            return np.frombuffer(gzip.decompress(base64.b64decode(value["array"]["data"])), value["dtype"])
        return value

    look(json.loads(figure))
    return found


def test_the_figure_has_what_the_picture_has() -> None:
    """One description gives both: all samples of a short channel are in the figure, to the last bit."""
    values = np.random.default_rng(4).normal(size=300)
    plot = channel_plot(Channel("force", "force", "N", values, rate_hz=100.0))
    assert plot is not None
    (source,) = columns(figure_json(plot, dark=False))
    np.testing.assert_array_equal(source["y"], values)
    np.testing.assert_allclose(source["x"], np.arange(300) / 100)
    assert len(drawn_y(Channel("force", "force", "N", values, rate_hz=100.0))[0]) == 300


def test_a_figure_takes_the_colours_of_the_page_and_no_formula() -> None:
    """Dark and light differ by their colours; a name in dollars is text, as a formula would load more code."""
    plot = channel_plot(Channel("$$x", "odd", None, np.arange(3.0)))
    assert plot is not None
    light, dark = (figure_json(plot, dark=dark).decode() for dark in (False, True))
    assert "#2166ac" in light
    assert "#79b4ea" in dark
    # each place where text could be taken for a formula
    assert light.count("$$") == light.count('"attributes": {"text": "$$') > 0


def test_sounds_in_files() -> None:
    """A WAV file of 16 bits gives its samples; what is none gives nothing."""
    samples = np.array([0.0, 0.5, -0.5])
    data = wav(samples, 8000.0)
    found = sound_in(data)
    assert found is not None
    assert found.rate_hz == 8000.0
    assert found.values == pytest.approx(samples, abs=1e-4)
    for broken in (b"", data[:20], data.replace(b"fmt ", b"fmtx"), data[:44]):
        assert sound_in(broken) is None


def test_a_tone_is_a_line_at_its_pitch() -> None:
    """The brightest row of a spectrogram of 1 kHz, sampled at 8 kHz, is a quarter of the way up."""
    import io

    from PIL import Image

    tone = np.sin(2 * np.pi * 1000 * np.arange(16_000) / 8000)
    picture = Image.open(io.BytesIO(spectrogram(Channel("sound", "pressure", "Pa", tone, rate_hz=8000.0)))).convert("L")
    level = np.asarray(picture, dtype=float).mean(axis=1)
    assert (len(level) - 1 - int(level.argmax())) / (len(level) - 1) == pytest.approx(0.25, abs=0.01)


def test_points_are_where_their_values_are() -> None:
    """Points of greater values lie further to the right, and error bars reach one SD to both sides."""
    results = [
        Result(
            recording=uuid4(),
            recorded_at=START,
            action="weighing",
            ground_truth=False,
            dataset="lab",
            thing="cup",
            kind="value",
            property="mass",
            value=value,
            sd=2.0,
            low=None,
            high=None,
            unit="g",
            given=None,
            label=None,
            owner=None,
            measured_by="arm",
        )
        for value in (10.0, 14.0, 20.0)
    ]
    found = points_plot("mass", results, [(15.0, "scale")], {"arm": 0})
    plot = drawn(found)
    x = [float(one) for one in re.findall(r'cx="([\d.]+)"', plot)]
    assert x == sorted(x)
    assert (x[1] - x[0]) / (x[2] - x[0]) == pytest.approx(0.4, abs=0.01)
    bars = [
        (float(a), float(b))
        for a, b in re.findall(r'<line x1="([\d.]+)" y1="[\d.]+" x2="([\d.]+)" y2="[\d.]+" class="bar', plot)
    ]
    assert [(a + b) / 2 for a, b in bars] == pytest.approx(x, abs=0.02)
    assert bars[0][1] - bars[0][0] == pytest.approx(x[1] - x[0], abs=0.05)
    assert found is not None
    source = next(one for one in columns(figure_json(found, dark=False)) if "low" in one)
    assert list(source["x"]) == [10.0, 14.0, 20.0]
    assert list(source["high"]) == [12.0, 16.0, 22.0]
    assert points_plot("mass", [], [(15.0, "scale")], {}) is None


def test_squeezes_are_laid_over_each_other_with_their_contacts_at_0() -> None:
    """Springs of one stiffness that begin at 40 and at 55 mm: both curves rise from 0; without an area it is force."""
    held = Held(area_mm2=600.0)
    laid = [
        Laid(f"at {width}", place, squeeze_of(spring(width, 1.5), held), None) for place, width in enumerate((40, 55))
    ]
    found = overlay(laid)
    assert found.plot is not None
    assert (found.plot.across, found.plot.up) == ("strain", "stress [kPa]")
    assert "Contact, where the fitted line begins, is at 0" in found.words
    for curve, width in zip(found.plot.curves, (40, 55), strict=True):
        assert curve.x.min() == pytest.approx(-5 / width, rel=0.05)
        assert np.interp(4 / width, curve.x, curve.y) == pytest.approx(1e3 * 1.5 * 4 / 600, rel=0.04)
        assert abs(curve.y[curve.x < -0.02]).max() < 0.2
    unknown = Laid("other", 2, squeeze_of(spring(30.0, 1.5), Held()), None)
    sound = Laid("sound", 3, None, channel_plot(Channel("sound", "sound", None, np.zeros(9))))
    found = overlay([*laid, unknown, sound])
    assert found.plot is not None
    assert found.plot.up == "force [N]"
    assert len(found.plot.curves) == 3
    assert found.left_out == ("sound",)
    assert "contact area is not known of all" in found.words


def test_signals_are_laid_over_each_other_where_their_units_agree() -> None:
    """Grams and grams, but not newtons; nothing where there is no curve."""
    plots = [channel_plot(Channel("load", "load", unit, np.arange(5.0), rate_hz=10.0)) for unit in ("g", "N", "g")]
    found = overlay([Laid(name, place, None, plots[place]) for place, name in enumerate("abc")])
    assert found.plot is not None
    assert [curve.name for curve in found.plot.curves] == ["a", "c"]
    assert found.left_out == ("b",)
    assert overlay([Laid("a", 0, None, None)]).plot is None


def believed(**belief: object) -> FinalBelief:
    return FinalBelief(uuid4(), START, 3, belief)  # type: ignore[arg-type]


def test_final_beliefs_stand_against_what_is_known() -> None:
    """A number with the stretch of nine tenths; the probability of the known label; nothing of what cannot be read."""
    mass = {"unit": "g", "mean": 66.0, "quantiles": {"0.05": 60.0, "0.5": 65.0, "0.95": 75.0}}
    material = {"probabilities": {"foam": 0.7, "wood": 0.3}}
    found = [believed(mass=mass, material=material), believed(mass={"unit": "g", "mean": "heavy"})]
    plot = beliefs_plot("mass", found, [(64.0, "scale")], None)
    assert plot is not None
    (point,) = plot.points
    assert (point.low, point.x, point.high) == (60.0, 66.0, 75.0)
    assert plot.levels[0].x == 64.0
    plot = beliefs_plot("material", found, [], "wood")
    assert plot is not None
    assert plot.points[0].x == pytest.approx(0.3)
    assert "foam with 70.0%" in plot.points[0].told
    assert plot.levels[0].x == 1.0
    assert beliefs_plot("volume", found, [], None) is None
    # kilograms and grams cannot stand beside each other
    assert beliefs_plot("mass", [*found, believed(mass={**mass, "unit": "kg"})], [], None) is None


@given(st.lists(st.floats(0, 1000), min_size=1, max_size=9), st.integers(1, 32))
def test_labels_of_what_is_known_are_whole_and_over_none(values: list[float], letters: int) -> None:
    """None leaves the plot or meets another one of its line; no line crosses one at the right of its own."""
    across = Scale(-100.0, 1100.0, 190.0, 744.0)
    placed = in_lines(known_levels([(value, "w" * letters) for value in values]), across)
    assert {one.level.x for one in placed} == {one.x for one in known_levels([(value, "") for value in values])}
    assert placed[0].line == 0
    told = [(one, *one.ends(across)) for one in placed if one.line is not None]
    for one, low, high in told:
        # at the left there is room, as above the names of rows there is nothing
        assert 0 <= low < high <= across.end
        for other, low_of_other, high_of_other in told:
            if other is not one and other.line == one.line:
                assert high < low_of_other or high_of_other < low
            if not one.at_left and other.line is not None and one.line is not None and other.line > one.line:
                assert not low < across.at(other.level.x) < high


def test_a_line_is_drawn_along_what_was_measured_and_no_further() -> None:
    """Where a line would begin before the first sample, no place of contact is told."""
    whole = spring(50, 1.5)
    for held in (Held(), Held(area_mm2=600.0)):
        told = squeeze_of(whole, held)
        assert told is not None
        assert told.hinge is not None
        late = told.gap_mm < 48.0
        found = replace(told, gap_mm=told.gap_mm[late], force_n=told.force_n[late])
        plot = squeeze_plot(found)
        measured, fitted = plot.curves
        assert (fitted.x.min(), fitted.x.max()) == (measured.x.min(), measured.x.max())
        assert "in contact from the first sample on" in plot.note
        assert "from contact at" not in plot.note
    assert "before the first sample" in squeeze_words(found)
    kept = squeeze_of(whole, Held())
    assert kept is not None
    assert "from contact at 50.01 mm" in squeeze_plot(kept).note
