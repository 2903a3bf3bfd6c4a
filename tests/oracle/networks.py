"""Networks for the oracle: the household one, and small ones that use what it does not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.network.families import Family, Gamma, LogNormal, Normal, StudentT, Uniform
from palpate.network.formula import Formula
from palpate.network.model import Action, Network
from palpate.network.noises import StudentTNoise
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty, Property
from palpate.network.sensors import ConfusionSensor, NumberSensor, Sensor
from tests.oracle.brute_force import Oracle
from tests.oracle.groups import product, total

Array = NDArray[np.float64]


def household_oracle(network: Network, refine: float = 1.0) -> Oracle:
    """Brute force for the household network: mass [g] = density [kg/m3] x volume [cm3] / 1000."""
    return Oracle(network, links=[product("mass", "density", "volume", 1e-3)], refine=refine)


def normal(mean: Any, sd: Any, low: float = -np.inf, high: float = np.inf) -> Normal:
    """A normal family with the same truncation for every configuration."""
    means = np.array(mean, float)
    return Normal(means, np.array(sd, float), np.full_like(means, low), np.full_like(means, high))


def network(name: str, properties: Sequence[Property], sensors: Mapping[str, Sensor]) -> Network:
    """A network of the properties and one action per sensor."""
    actions = {action: Action(action, 1.0, sensor) for action, sensor in sensors.items()}
    return Network(name, {p.name: p for p in properties}, actions)


def cube() -> Oracle:
    """Two and three categorical parents, lognormal, a derived cube of one property, relative noise, repeats."""
    given_b = np.array([[[0.7, 0.3], [0.2, 0.8], [0.5, 0.5]], [[0.9, 0.1], [0.4, 0.6], [0.05, 0.95]]])
    sides = LogNormal(np.array([[3.0, 4.0], [6.0, 5.0]]), np.array([[0.2, 0.3], [0.1, 0.4]]))
    properties: list[Property] = [
        CategoricalProperty("kind", ("a", "b"), (), np.array([0.35, 0.65])),
        CategoricalProperty("make", ("x", "y", "z"), ("kind",), np.array([[0.5, 0.3, 0.2], [0.1, 0.2, 0.7]])),
        CategoricalProperty("finish", ("matt", "gloss"), ("kind", "make"), given_b),
        ContinuousProperty(
            "side",
            "cm",
            ("kind", "finish"),
            sides,
        ),
        ContinuousProperty("heat", "K", ("make",), Gamma(np.array([2.0, 5.0, 9.0]), np.array([4.0, 3.0, 1.0]))),
        DerivedProperty("bulk", "cm**3", Formula.parse("side ** 3")),
    ]
    look = np.array([[0.6, 0.2, 0.1], [0.3, 0.7, 0.2], [0.1, 0.1, 0.7]])
    sensors: dict[str, Sensor] = {
        "look": ConfusionSensor("make", ("x", "y", "z"), look, repeat_probability=0.6),
        "glint": ConfusionSensor("finish", ("dull", "bright", "odd"), np.array([[0.7, 0.1], [0.2, 0.6], [0.1, 0.3]])),
        "ruler": NumberSensor("side", 0.3),
        "dunk": NumberSensor("bulk", 5.0, relative_sd=0.1),
        "touch": NumberSensor("heat", 2.0, low=3.0, offset_sd=1.5),
    }
    return Oracle(network("cube", properties, sensors), functions={"bulk": ("side", lambda x: x**3, np.cbrt)})


def stack() -> Oracle:
    """A derived sum of two properties, heavy-tailed noise, an offset shared by repetitions, saturation low."""
    properties: list[Property] = [
        CategoricalProperty("left", ("p", "q", "r"), (), np.array([0.2, 0.3, 0.5])),
        CategoricalProperty("right", ("u", "v"), ("left",), np.array([[0.5, 0.5], [0.9, 0.1], [0.3, 0.7]])),
        ContinuousProperty("lower", "cm", ("left",), normal([4.0, 7.0, 12.0], [1.0, 2.0, 1.5])),
        ContinuousProperty("upper", "cm", ("right",), Gamma(np.array([4.0, 9.0]), np.array([1.0, 0.8]))),
        DerivedProperty("height", "cm", Formula.parse("lower + upper")),
    ]
    glance = np.array([[0.8, 0.2, 0.1], [0.1, 0.6, 0.3], [0.1, 0.2, 0.6]])
    sensors: dict[str, Sensor] = {
        "glance": ConfusionSensor("left", ("p", "q", "r"), glance),
        "rod": NumberSensor("height", 0.8, offset_sd=0.5),
        "laser": NumberSensor("height", 0.6, noise=StudentTNoise(4.0)),
        "gauge": NumberSensor("lower", 1.0, low=5.0),
    }
    return Oracle(network("stack", properties, sensors), links=[total("height", "lower", "upper")])


def singles() -> Oracle:
    """Uniform, heavy-tailed and truncated families; relative, heavy-tailed and offset sensors; no parents too."""
    families: dict[str, tuple[tuple[str, ...], Family]] = {
        "fill": (("kind",), Uniform(np.array([0.0, 20.0]), np.array([40.0, 100.0]))),
        "drift": (("kind",), StudentT(np.array([0.0, 3.0]), np.array([1.0, 2.0]), np.array([5.0, 8.0]))),
        "gap": ((), normal(2.0, 3.0, low=0.0, high=6.0)),
    }
    properties: list[Property] = [CategoricalProperty("kind", ("a", "b"), (), np.array([0.4, 0.6]))]
    properties += [ContinuousProperty(name, "mm", parents, family) for name, (parents, family) in families.items()]
    sensors: dict[str, Sensor] = {
        "float": NumberSensor("fill", 1.0, relative_sd=0.05, low=5.0, high=90.0),
        "probe": NumberSensor("drift", 0.7, noise=StudentTNoise(3.0), offset_sd=0.6),
        "feeler": NumberSensor("gap", 0.4, offset_sd=0.5, high=5.0),
        "sight": ConfusionSensor("kind", ("a", "b"), np.array([[0.8, 0.3], [0.2, 0.7]]), repeat_probability=0.9),
    }
    return Oracle(network("singles", properties, sensors))
