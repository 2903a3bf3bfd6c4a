"""What the exact engine works out once, and what it refuses."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from palpate.errors import NetworkError
from palpate.inference.exact import ExactBelief
from palpate.network.reading import load_network
from palpate.outcomes import Reading

BOX = """
format = "palpate-network/1"
name = "boxes"
[properties.kind]
states = ["small", "large"]
[properties.length]
unit = "cm"
family = "lognormal"
parents = ["kind"]
given.small = {{median = 10, log_sd = {spread}}}
given.large = {{median = 30, log_sd = {spread}}}
[properties.width]
unit = "cm"
family = "lognormal"
median = 8
log_sd = {spread}
[properties.height]
unit = "cm"
family = "gamma"
shape = 9
scale = 1
[properties.volume]
unit = "cm^3"
formula = "length * width * height"
[actions.dip]
cost_s = 10
[actions.dip.sensor]
property = "volume"
kind = "normal"
sd = 50
relative_sd = 0.2
"""


def boxes(folder: Path, spread: float) -> ExactBelief:
    path = folder / "boxes.toml"
    path.write_text(BOX.format(spread=spread))
    return ExactBelief(load_network(str(path)))


def test_three_linked_properties(tmp_path: Path) -> None:
    """A reading of the product of three properties moves all of them as importance sampling says."""
    belief = boxes(tmp_path, 0.3)
    draws = belief.sample(400_000, np.random.default_rng(4))
    truth = np.asarray(draws["volume"], float)
    scale = np.hypot(50, 0.2 * truth)
    weights = np.exp(-0.5 * ((2000 - truth) / scale) ** 2) / scale
    weights /= weights.sum()
    after = belief.update("dip", Reading(2000.0))
    assert after.probabilities("kind")[1] == pytest.approx(weights @ (draws["kind"] == "large"), abs=0.01)
    for name in ("length", "width", "height", "volume"):
        marginal = after.marginal(name)
        values = np.asarray(draws[name], float)
        mean = float(weights @ values)
        sd = float(np.sqrt(weights @ (values - mean) ** 2))
        assert getattr(marginal, "mean", np.nan) == pytest.approx(mean, abs=0.03 * sd), name
        assert getattr(marginal, "sd", np.nan) == pytest.approx(sd, rel=0.03), name


def test_too_narrow_a_link_is_refused(tmp_path: Path) -> None:
    """Three properties whose charts would be too large are refused with the number."""
    with pytest.raises(NetworkError, match=r"'boxes': length, width, height are linked .* more than 2e\+07"):
        boxes(tmp_path, 0.003)
