"""Groups of continuous properties: which of them can be the axes of a chart."""

from collections.abc import Mapping
from itertools import permutations
from typing import Any

import numpy as np
import pytest

from palpate.errors import EvidenceError
from palpate.inference.exact import ExactBelief
from palpate.inference.group import Group
from palpate.inference.grouping import groups_of
from palpate.inference.marginals import ContinuousMarginal
from palpate.network.families import LogNormal, Normal, Uniform
from palpate.network.formula import Formula
from palpate.network.model import Action, Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property
from palpate.network.reading import load_network
from palpate.network.sensors import NumberSensor
from palpate.outcomes import Reading


def network(formulas: Mapping[str, str], bases: str = "abc", sensors: Mapping[str, float] | None = None) -> Network:
    """Lognormal bases with one categorical parent each, and derived properties."""
    properties: dict[str, Property] = {"kind": CategoricalProperty("kind", ("p", "q"), (), np.array([0.4, 0.6]))}
    for i, name in enumerate(bases):
        family = LogNormal(np.array([2.0 + i, 3.0 + i]), np.array([0.2, 0.3]))
        properties[name] = ContinuousProperty(name, "m", ("kind",), family)
    for name, text in formulas.items():
        properties[name] = DerivedProperty(name, "m", Formula.parse(text))
    actions = {f"see-{n}": Action(f"see-{n}", 1.0, NumberSensor(n, sd)) for n, sd in (sensors or {}).items()}
    return Network("toy", properties, actions)


BOTH = {"area": "a * b", "rim": "c - a"}
KNOT = {"total": "a + b", "times": "a * b", "rim": "a + c"}


def only(made: Network) -> Group:
    (group,) = groups_of(made)
    return group


def test_household_has_two_groups() -> None:
    """Elasticity stands alone; density, volume and mass are linked by the mass's formula."""
    groups = groups_of(load_network("household"))
    assert [g.members for g in groups] == [("elasticity",), ("density", "volume", "mass")]
    assert [g.parents for g in groups] == [("material",), ("category", "material")]
    assert [len(g.sensors) for g in groups] == [1, 1]


def test_formulas_link_groups() -> None:
    """Properties are in one group when a chain of formulas links them, and only then."""
    made = network({"ab": "a + b", "cd": "c * d"}, "abcde")
    assert [g.members for g in groups_of(made)] == [("a", "b", "ab"), ("c", "d", "cd"), ("e",)]
    chained = network({"ab": "a + b", "cd": "c * d", "bd": "b - d"}, "abcde")
    assert [set(g.members) for g in groups_of(chained)] == [{"a", "b", "c", "d", "ab", "cd", "bd"}, {"e"}]


def test_a_chart_has_the_members_asked_for() -> None:
    """A frame has as many axes as bases, what is asked for and has evidence among them, and bases for the rest."""
    group = only(network({"area": "a * b", "box": "a * b * c"}))
    assert axes(group) == {"a", "b", "c"}
    assert axes(group, "box") == {"box", *axes(group, "box")}
    assert len(axes(group, "box") & set("abc")) == 2
    assert {"area", "box"} <= axes(group, "area", "box")
    assert "area" in axes(group, touched=("area",))
    assert {"area", "c"} <= axes(group, "c", touched=("area",))
    # c follows from area and box
    assert group.frame(("area", "box", "c")) is None


def axes(group: Group, *required: str, touched: tuple[str, ...] = ()) -> set[str]:
    frame = group.frame(required, frozenset(touched))
    assert frame is not None
    assert len(frame.axes) == len(group.bases)
    return set(frame.axes)


def test_a_frame_solves_its_formulas() -> None:
    """Bases solved for from a frame's axes give the derived axes again, with the slope of the change."""
    group = only(network(BOTH))
    frame = group.frame(("area", "rim"))
    assert frame is not None
    true = {"a": 2.0, "b": 3.5, "c": 7.0}
    true |= {name: float(d.formula.evaluate(true)) for name, d in group.derived.items()}
    points = {name: np.array(true[name]) for name in frame.axes}
    values, log_slope = frame.values(points)
    assert {name: float(values[name]) for name in "abc"} == pytest.approx({name: true[name] for name in "abc"})
    step, others = 1e-6, [name for name in frame.axes if name in group.derived]
    jacobian = np.zeros((2, 2))
    solved = [base for _, base in frame.order]
    for row, name in enumerate(others):
        for column, base in enumerate(solved):
            moved = group.derived[name].formula.evaluate({**true, base: true[base] + step})
            jacobian[row, column] = (float(moved) - true[name]) / step
    assert float(log_slope) == pytest.approx(-np.log(abs(np.linalg.det(jacobian))), abs=1e-5)


@pytest.mark.parametrize(
    ("names", "rank"),
    [
        (("a",), 1),
        (("a", "b"), 2),
        (("area",), 1),
        (("a", "b", "area"), 2),
        (("area", "rim"), 2),
        (("area", "twice"), 1),
        (("area", "rim", "twice"), 2),
        (("a", "area", "rim"), 3),
        (("a", "b", "c", "area", "rim", "twice"), 3),
    ],
)
def test_rank_counts_degrees_of_freedom(names: tuple[str, ...], rank: int) -> None:
    """The rank of members is the number of them that do not follow from the others."""
    group = only(network({**BOTH, "twice": "2 * a * b"}))
    assert all(group.rank(order) == rank for order in permutations(names[:4]) if len(names) <= 4)
    assert group.rank(names) == rank


def test_rank_does_not_depend_on_units() -> None:
    """Bases of very different size count alike."""
    one = np.array(1.0)
    tiny, huge = LogNormal(1e-7 * one, 0.1 * one), LogNormal(1e7 * one, 0.1 * one)
    properties: dict[str, Property] = {
        "tiny": ContinuousProperty("tiny", "m", (), tiny),
        "huge": ContinuousProperty("huge", "m", (), huge),
        "both": DerivedProperty("both", "m", Formula.parse("tiny * huge")),
    }
    group = only(Network("sizes", properties, {}))
    assert [group.rank(n) for n in (("tiny", "both"), ("huge", "both"), ("tiny", "huge", "both"))] == [2, 2, 2]


def test_properties_that_cannot_be_solved_for_each_other_have_no_chart() -> None:
    """A sum and a product of the same two have no chart, each of them has one."""
    group = only(network(KNOT))
    assert group.frame(("total", "times")) is None
    assert "total" in axes(group, "total")
    assert "times" in axes(group, "times")
    assert group.rank(("total", "times")) == 2


def test_an_objective_of_them_is_refused() -> None:
    """Learning both of two that cannot be solved for each other is refused, and a third that settles them is not."""
    belief = ExactBelief(network(KNOT, sensors={"times": 1.0}))
    with pytest.raises(EvidenceError, match=r"objective of total, times together cannot be worked out.*choose fewer"):
        belief.expected_gains([("total", "times")])
    (gains,) = belief.expected_gains(["times", "c", ("total", "a", "times"), "everything"]).values()
    # total and a give b, and so times: with them all of the sensor's information is told
    assert gains["total", "a", "times"] == pytest.approx(gains["everything"], abs=1e-3)
    assert gains["times"] == pytest.approx(gains["everything"], abs=1e-3)


def test_what_one_tells_of_the_other_is_that_of_a_grid() -> None:
    """A reading of a product tells of the sum of the same two what a fine grid over both says."""
    step = np.arange(1501) / 300 - 2.5
    a, b = 2.0 * np.exp(step)[:, None], 3.0 * np.exp(step)[None, :]
    p = np.exp(-0.5 * (step[:, None] ** 2 + step[None, :] ** 2) / 0.3**2)
    rows, columns = np.linspace(0.0, 16.0, 1201), np.linspace(0.0, 32.0, 1601)
    joint, _, _ = np.histogram2d(np.ravel(a + b), np.ravel(a * b), [rows, columns], weights=np.ravel(p / p.sum()))
    y = np.linspace(-3.0, 35.0, 600)
    seen = joint @ np.exp(-0.5 * ((y[None, :] - (columns[1:] + columns[:-1])[:, None] / 2) / 0.6) ** 2)
    seen /= seen.sum()
    held = seen > 0
    independent = seen.sum(axis=0)[None, :] * seen.sum(axis=1)[:, None]
    expected = float((seen[held] * np.log2(seen[held] / independent[held])).sum())
    gains = knot().expected_gains(["total"], ["see-times"])
    assert gains["see-times"]["total"] == pytest.approx(expected, abs=5e-3)


def knot() -> ExactBelief:
    """A sum and a product of the same two properties, and sensors of both."""
    sds = {"total": 0.3, "times": 0.6, "a": 0.2}
    one = np.array(1.0)
    properties: dict[str, Property] = {
        "a": ContinuousProperty("a", "m", (), LogNormal(2 * one, 0.3 * one)),
        "b": ContinuousProperty("b", "m", (), LogNormal(3 * one, 0.3 * one)),
        "total": DerivedProperty("total", "m", Formula.parse("a + b")),
        "times": DerivedProperty("times", "m", Formula.parse("a * b")),
    }
    actions = {f"see-{n}": Action(f"see-{n}", 1.0, NumberSensor(n, sd)) for n, sd in sds.items()}
    return ExactBelief(Network("knot", properties, actions))


def grid_posterior(seen: Mapping[str, tuple[float, float]], formulas: Mapping[str, Any]) -> Any:
    """Means and SDs by brute force over a, b of a network with two bases and one state."""
    a = np.exp(np.linspace(np.log(2.0) - 2.5, np.log(2.0) + 2.5, 1501))[:, None]
    b = np.exp(np.linspace(np.log(3.0) - 2.5, np.log(3.0) + 2.5, 1501))[None, :]
    # uniform in the logarithm: the lognormal densities in it are normal
    log_p = -0.5 * (np.log(a / 2.0) / 0.3) ** 2 - 0.5 * (np.log(b / 3.0) / 0.3) ** 2
    values = {"a": a + 0 * b, "b": b + 0 * a, **{name: f(a, b) for name, f in formulas.items()}}
    for name, (y, sd) in seen.items():
        log_p = log_p - 0.5 * ((y - values[name]) / sd) ** 2
    p = np.exp(log_p - log_p.max())
    p /= p.sum()
    means = {name: float((p * x).sum()) for name, x in values.items()}
    return {name: (means[name], float(np.sqrt((p * (x - means[name]) ** 2).sum()))) for name, x in values.items()}


@pytest.mark.parametrize(
    "seen",
    [
        {"total": (6.0, 0.3)},
        {"times": (5.0, 0.5)},
        {"total": (6.0, 0.3), "times": (8.0, 0.6)},
        {"a": (1.5, 0.2), "times": (8.0, 0.6)},
    ],
    ids=["sum", "product", "both", "base"],
)
def test_evidence_on_both_is_that_of_a_grid(seen: Mapping[str, tuple[float, float]]) -> None:
    """Evidence on a sum and a product of the same two properties gives the moments of brute force."""
    belief = knot()
    for name, (y, sd) in seen.items():
        belief = belief.update(f"see-{name}", Reading(y, sd))
    expected = grid_posterior(seen, {"total": lambda a, b: a + b, "times": lambda a, b: a * b})
    for name, (mean, sd) in expected.items():
        marginal = belief.marginal(name)
        assert isinstance(marginal, ContinuousMarginal)
        assert (marginal.mean, marginal.sd) == pytest.approx((mean, sd), abs=2e-3 * sd), name


def test_supports_and_corners() -> None:
    """A member's support is that of its densities, and corners are where they end at once."""
    box = Uniform(np.array([0.0, 2.0]), np.array([5.0, 9.0]))
    cut = Normal(np.array([1.0, 2.0]), np.array([1.0, 1.0]), np.array([0.0, 0.0]), np.array([np.inf, np.inf]))
    properties: dict[str, Property] = {
        "kind": CategoricalProperty("kind", ("p", "q"), (), np.array([0.4, 0.6])),
        "fill": ContinuousProperty("fill", "m", ("kind",), box),
        "length": ContinuousProperty("length", "m", ("kind",), cut),
        "area": DerivedProperty("area", "m", Formula.parse("fill * length")),
    }
    group = only(Network("ends", properties, {}))
    assert group.support("fill") == (0.0, 9.0)
    assert group.support("length") == (0.0, np.inf)
    assert group.support("area") == (0.0, np.inf)
    assert group.corners("fill").tolist() == [0.0, 2.0, 5.0, 9.0]
    assert group.corners("length").tolist() == [0.0]
