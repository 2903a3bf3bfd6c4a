from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from palpate.errors import EvidenceError
from palpate.network.families import LogNormal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.selection.objectives import Everything, Learn, Weighted

NETWORK = Network(
    "toy",
    {
        "stuff": CategoricalProperty("stuff", ("oak", "clay"), (), np.full(2, 0.5)),
        "shape": CategoricalProperty("shape", ("ball", "bar"), (), np.full(2, 0.5)),
        "weight": ContinuousProperty("weight", "g", (), LogNormal(np.array(50.0), np.array(0.5))),
    },
    {},
)
GAINS = {"stuff": 0.5, ("stuff", "shape"): 0.75, "weight": 2.0, "everything": 3.0}


def belief(table: Any = ((0.25, 0.25), (0.25, 0.25))) -> Any:
    """Stands for an engine: it answers with numbers made up for each key of an objective."""
    joint = np.array(table)

    def probabilities(*names: Any) -> Any:
        return {("stuff",): joint.sum(axis=1), ("shape",): joint.sum(axis=0), ("stuff", "shape"): joint}[names]

    return SimpleNamespace(
        network=NETWORK,
        probabilities=probabilities,
        expected_gains=lambda keys, actions: {a: {key: GAINS.get(key) for key in keys} for a in actions},
        realised_gain=lambda after, key: GAINS.get(key),
    )


@pytest.mark.parametrize(
    ("objective", "gain", "name", "properties"),
    [
        (Learn("stuff"), 0.5, "stuff", ("stuff",)),
        (Learn("stuff", "shape"), 0.75, "stuff, shape", ("stuff", "shape")),
        (Everything(), 3.0, "everything", ()),
        (Weighted({Learn("stuff"): 2.0, Learn("weight"): 0.5}), 2.0, "2 x stuff + 0.5 x weight", ("stuff", "weight")),
        (Weighted({Learn("stuff"): 1.0, Everything(): 1.0}), 3.5, "1 x stuff + 1 x everything", ()),
    ],
)
def test_an_objective_asks_the_engine_for_its_own_information(
    objective: Any, gain: float, name: str, properties: tuple[str, ...]
) -> None:
    """Gains and realised gains are those of the objective's properties taken together."""
    assert objective.gains(belief(), ["look", "weigh"]) == {"look": gain, "weigh": gain}
    assert objective.realised(belief(), belief()) == gain
    assert objective.name == name
    assert objective.properties == properties


def test_entropy_drop_is_for_categorical_objectives() -> None:
    """The fall of the joint entropy is given for categorical properties, and for no others."""
    before, after = belief(), belief([[0.5, 0.5], [0.0, 0.0]])
    assert Learn("stuff").entropy_drop(before, after) == pytest.approx(1.0)
    assert Learn("shape").entropy_drop(before, after) == pytest.approx(0.0)
    assert Learn("stuff", "shape").entropy_drop(before, after) == pytest.approx(1.0)
    assert Weighted({Learn("stuff"): 3.0}).entropy_drop(before, after) == pytest.approx(3.0)
    assert Learn("weight").entropy_drop(before, after) is None
    assert Weighted({Learn("stuff"): 1.0, Learn("weight"): 1.0}).entropy_drop(before, after) is None
    assert Everything().entropy_drop(before, after) is None


def test_a_gain_that_the_engine_cannot_give_is_an_error() -> None:
    """An objective without gains cannot guide an exploration: the error names action and objective."""
    with pytest.raises(EvidenceError, match="cannot say what action 'look' tells about 'shape'"):
        Learn("shape").gains(belief(), ["look"])
    assert Learn("shape").realised(belief(), belief()) is None
    assert Weighted({Learn("shape"): 1.0}).realised(belief(), belief()) is None


@pytest.mark.parametrize("weight", [0.0, -1.0, float("inf"), float("nan")])
def test_weights_are_above_zero(weight: float) -> None:
    """A weight that is not a finite number above zero is refused."""
    with pytest.raises(EvidenceError, match="expected a number above zero"):
        Weighted({Learn("stuff"): weight})


def test_empty_objectives_are_refused() -> None:
    """An objective is about something."""
    with pytest.raises(EvidenceError, match="no property"):
        Learn()
    with pytest.raises(EvidenceError, match="no objective"):
        Weighted({})


def test_a_property_named_twice_counts_once() -> None:
    """To learn a property and the same again is to learn it."""
    assert Learn("material", "material") == Learn("material")
    assert Learn("material", "category", "material").properties == ("material", "category")
