"""Exact beliefs about drawn objects are as sure as they are right."""

import numpy as np
import pytest

from palpate.experiments.comparison.calibration_findings import numbers
from palpate.experiments.comparison.plan import calibration_tasks
from palpate.experiments.comparison.results import Results
from tests.experiments.made_up import results

OBJECTS = 400


@pytest.fixture(scope="module")
def own() -> Results:
    return results([row for task in calibration_tasks(OBJECTS, seed=11) for row in task.run()])


@pytest.mark.parametrize("name", ["category", "material"])
def test_cross_entropy_is_entropy_on_average(own: Results, name: str) -> None:
    """The mean difference of cross-entropy and entropy is zero within four standard errors."""
    gap = own.numbers(f"{name}_cross_entropy_bits") - own.numbers(f"{name}_entropy_bits")
    assert abs(gap.mean()) < 4 * gap.std() / np.sqrt(OBJECTS)


@pytest.mark.parametrize("name", ["category", "material"])
def test_confidence_is_accuracy_on_average(own: Results, name: str) -> None:
    """The most probable state is true as often as its probability says, within four standard errors."""
    gap = own.numbers(f"{name}_confidence") - own.numbers(f"{name}_correct")
    assert abs(gap.mean()) < 4 * gap.std() / np.sqrt(OBJECTS)


def test_intervals_hold_what_they_should(own: Results) -> None:
    """Of each continuous property half of the truths are in the middle half, and nine tenths in the middle 90 %."""
    found = numbers(own)
    assert {one.name for one in found} == {"elasticity", "density", "volume", "mass"}
    for one in found:
        assert one.within_50 == pytest.approx(0.5, abs=4 * np.sqrt(0.25 / OBJECTS))
        assert one.within_90 == pytest.approx(0.9, abs=4 * np.sqrt(0.09 / OBJECTS))
