import re
from uuid import uuid4

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.server.plots.curves import channel_plot, squeeze_of
from palpate.server.plots.points import points_plot
from palpate.server.plots.scale import spanning
from palpate.server.plots.spectrogram import spectrogram
from palpate.store.records import Channel, Series
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


def drawn_y(channel: Channel) -> list[list[float]]:
    plot = str(channel_plot(channel))
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
    plot = str(channel_plot(Channel("odd", "odd", None, values)))
    assert not re.search(r'="[^"]*\b(nan|inf)\b', plot)


def test_the_line_through_a_squeeze_is_found() -> None:
    """A spring of 2 N/mm that begins at 50 mm is fitted as that."""
    gap = np.linspace(60, 40, 100)
    force = 2.0 * np.maximum(0.0, 50 - gap) + np.random.default_rng(1).normal(0, 0.05, 100)
    channels = Channel("position", "length", "mm", gap), Channel("force", "force", "N", force)
    found = squeeze_of(Series("gripper", channels))
    assert found is not None
    assert found.hinge is not None
    assert found.hinge.slope == pytest.approx(2.0, rel=0.02)
    assert found.hinge.contact == pytest.approx(50.0, abs=0.1)
    assert squeeze_of(Series("gripper", channels[:1])) is None


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
            uuid4(), START, "weighing", False, "lab", "cup", "value", "mass", value, 2.0, None, None, "g", None, "arm"
        )
        for value in (10.0, 14.0, 20.0)
    ]
    plot = str(points_plot("mass", results, [(15.0, "scale")]))
    x = [float(one) for one in re.findall(r'cx="([\d.]+)"', plot)]
    assert x == sorted(x)
    assert (x[1] - x[0]) / (x[2] - x[0]) == pytest.approx(0.4, abs=0.01)
    bars = [
        (float(a), float(b))
        for a, b in re.findall(r'<line x1="([\d.]+)" y1="[\d.]+" x2="([\d.]+)" y2="[\d.]+" class="bar', plot)
    ]
    assert [(a + b) / 2 for a, b in bars] == pytest.approx(x, abs=0.02)
    assert bars[0][1] - bars[0][0] == pytest.approx(x[1] - x[0], abs=0.05)
    assert points_plot("mass", [], [(15.0, "scale")]) is None
