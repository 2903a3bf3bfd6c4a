"""The scores of a belief as columns."""

import numpy as np
import pytest

import palpate
from palpate.experiments.comparison.scores import scores
from palpate.inference.marginals import ContinuousMarginal
from palpate.inference.message_passing import MessagePassingBelief

NETWORK = palpate.load_network("household")


def test_scores_of_the_prior_are_known() -> None:
    """A uniform belief over ten categories: log2 10 bits, Brier 0.9, and no surprise in the median."""
    belief = palpate.ExactBelief(NETWORK)
    mass = belief.marginal("mass")
    assert isinstance(mass, ContinuousMarginal)
    median = mass.quantile(0.5)
    row = scores(belief, {"category": "dice", "mass": median})
    assert [row["category_cross_entropy_bits"], row["category_entropy_bits"]] == pytest.approx([np.log2(10)] * 2)
    assert row["category_brier"] == pytest.approx(0.9)
    assert row["category_truth"] == 4
    assert row["mass_rank"] == pytest.approx(0.5, abs=1e-6)
    assert row["material_brier"] is None


def test_an_engine_that_says_nothing_of_a_property_has_no_score_for_it() -> None:
    """Message passing has no belief about mass."""
    row = scores(MessagePassingBelief(NETWORK), {"mass": 100.0, "density": 1000.0})
    assert (row["mass_crps"], row["mass_rank"], row["mass_sd"]) == (None, None, None)
    assert row["density_crps"] is not None
