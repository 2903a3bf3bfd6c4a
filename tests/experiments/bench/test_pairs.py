"""Look-alikes: which of the two it was, and where that showed."""

import math

import pytest
from scipy import stats

from palpate.experiments.bench.pairs import evidence_bits, partner_of, telling_rows
from palpate.experiments.tapes import Tape
from palpate.outcomes import Above, Failed, Label, Outcome, Posterior, Reading
from tests.experiments.bench.made_up import NETWORK

GLASS, PLASTIC = NETWORK.object("wineglass"), NETWORK.object("wineglass_ycb")


def test_partners() -> None:
    """Either of a pair has the other; others have none."""
    for one, other in (("banana", "banana_ycb"), ("stiff_yellow_sponge", "soft_yellow_sponge")):
        found = [partner_of(NETWORK, name) for name in (one, other)]
        assert [partner.name for partner in found if partner] == [other, one]
    assert partner_of(NETWORK, "ceramic_mug") is None


def test_a_weight_tells_as_much_as_its_densities_say() -> None:
    """The ratio of normal densities about the two masses, by scipy; the other way round the same with other sign."""
    by_hand = (stats.norm(133, 6).logpdf(137) - stats.norm(150, 6).logpdf(137)) / math.log(2)
    assert evidence_bits(NETWORK, "weighing", Reading(137.0), PLASTIC, GLASS) == pytest.approx(by_hand)
    assert evidence_bits(NETWORK, "weighing", Reading(137.0), GLASS, PLASTIC) == pytest.approx(-by_hand)


@pytest.mark.parametrize("outcome", [Failed("it fell"), Label("glass"), Posterior({"glass": 1.0})], ids=str)
def test_what_says_nothing(outcome: Outcome) -> None:
    """Failures, vectors, and labels of what is the same or not known of both."""
    action = "weighing" if isinstance(outcome, Failed) else "mat-vision"
    pair = (NETWORK.object("banana"), NETWORK.object("banana_ycb"))
    assert evidence_bits(NETWORK, action, outcome, *pair) == 0.0
    assert evidence_bits(NETWORK, "cat-vision", Label("wineglass"), PLASTIC, GLASS) == 0.0


def test_the_step_that_reveals_a_trick_is_the_surprising_one() -> None:
    """A camera sees glass, and a scale weighs what no glass weighs: that step has the least surprise number."""
    truth = {name: value.value for name, value in PLASTIC.truth.items()}
    outcomes: dict[str, Outcome] = {"cat-vision": Label("wineglass"), "weighing": Reading(150.0)}
    outcomes["squeezing"] = Reading(20.0)
    rows = list(telling_rows(NETWORK, Tape("wineglass_ycb", 0, outcomes, truth, trick=True)))
    assert [row["step"] for row in rows] == [1, 2, 3]
    surprise = {row["used"]: float(str(row["surprise"])) for row in rows}
    assert min(surprise, key=surprise.__getitem__) == "squeezing"
    assert surprise["squeezing"] < 0.1
    bits = {row["used"]: float(str(row["pair_bits"])) for row in rows}
    assert bits["squeezing"] > 10
    assert evidence_bits(NETWORK, "squeezing", Above(95.0), PLASTIC, GLASS) < 0
