"""Claims of the paper, checked on tables made by hand."""

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pytest

from palpate.experiments.frames import Frame
from palpate.experiments.reproduction.claims import CHECKS, check, verdicts
from palpate.experiments.reproduction.paper import Claim, paper
from palpate.experiments.reproduction.tasks import GREEDY, RANDOM
from palpate.experiments.reproduction.verdict import Finding, Verdict

ACTIONS = ("look", "lift")


def run(thing: str, actions: Sequence[str], entropies: Sequence[float], **more: Any) -> list[dict[str, Any]]:
    """The rows of a run; it stops after `stop` actions."""
    stop = more.pop("stop", len(actions))
    rows = []
    for step, entropy in enumerate(entropies):
        rows.append({
            "engine": "exact", "arm": GREEDY, "objective": "category", "object": thing, "step": step,
            "action": actions[step - 1] if step else None, "stopped": step > stop,
            "stop": "enough" if step == stop else None,
            "entropy_bits": entropy, "entropy_drop_bits": entropies[step - 1] - entropy if step else math.nan,
            "cross_entropy_category_bits": entropy + 0.1,
            "gain_look_bits": 0.5, "gain_lift_bits": -0.2 if step == 0 else 0.1, **more,
        })  # fmt: skip
    return rows


def frame(*runs: Sequence[Mapping[str, Any]]) -> Frame:
    rows = [row for own in runs for row in own]
    texts = ("engine", "arm", "objective", "object", "action", "stop")
    return Frame({
        name: np.array([row[name] for row in rows], dtype=object if name in texts else None) for name in rows[0]
    })  # fmt: skip


STEPS = frame(
    run("mug", ["look", "lift"], [3.0, 1.0, 0.5], stop=1),
    run("box", ["look", "lift"], [3.0, 1.0, 1.5]),
    run("can", ["look", "lift"], [3.0, 1.0, 0.5]),
    run("mug", ["lift", "look"], [3.0, 2.0, 0.5], arm=RANDOM),
    run("box", ["lift", "look"], [3.0, 2.5, 1.5], arm=RANDOM),
    run("can", ["lift", "look"], [3.0, 1.5, 1.5], arm=RANDOM),
)


@pytest.mark.parametrize(
    ("kind", "action", "holds", "figure"),
    [
        ("first", "look", True, "3 of 3 runs (100%)"),
        ("first", "lift", False, "0 of 3 runs (0%); look 3"),
        ("stops-after-first", "", True, "1 of 3 runs (33%)"),
        ("second", "lift", True, "2 of 2 runs (100%)"),
        ("all-taken", "", True, "2 of 3 runs (67%)"),
        ("entropy-below-random", "", True, "1.00 / 2.00 bits after action 1, 2, ..."),
        ("falls-most-first", "", True, "falls by 2.00, 0.17 bits"),
        ("entropy-rises", "", True, "1 of 3 further measurements (33%)"),
        ("no-negative-gain", "", False, "lift on category -0.20"),
    ],
)
def test_a_claim_is_counted(kind: str, action: str, holds: bool, figure: str) -> None:
    """Each kind of claim gives the verdict and the figure that counting by hand gives."""
    assert check(STEPS, Claim(kind, ("category",), "", action)) == Finding(holds, figure)


def test_scores_are_compared_object_by_object() -> None:
    """The difference of the mean cross-entropies is that of the objects' means, with its interval."""
    found = check(STEPS, Claim("cross-entropy-below-random", ("category",), ""))
    # after the actions: mug 0.75, box 1.25, can 0.75 against 1.25, 2, 1.5
    assert found.holds
    assert found.figure.startswith("1.02 / 1.68 bits, difference -0.67 [-0.75, -0.50]")
    assert not found.chance


def test_no_run_tells_nothing() -> None:
    """Where every run had stopped, nothing can be said of a second action."""
    stopped = frame(run("mug", ["look", "lift"], [3.0, 1.0, 0.5], stop=1))
    assert check(stopped, Claim("second", ("category",), "", "lift")).holds is None


@pytest.mark.parametrize(
    ("holds", "words"),
    [
        ((True, True), "holds"),
        ((False, False), "does not hold"),
        ((True, False), "holds only as released"),
        ((False, True), "holds only for exact"),
        ((None, True), "holds"),
        ((None, None), "no run can tell"),
    ],
)
def test_verdicts_put_the_engines_together(holds: tuple[bool | None, bool | None], words: str) -> None:
    """The verdict says for which engines a claim holds."""
    findings = {engine: Finding(held, "") for engine, held in zip(("as-released", "exact"), holds, strict=True)}
    assert Verdict(paper().claims[0], findings).words == words


def test_the_few_that_differ_are_named() -> None:
    """Where most engines agree, the verdict names the others."""
    held = {"as-released": True, "as-written": False, "exact": True}
    findings = {engine: Finding(holds, "") for engine, holds in held.items()}
    assert Verdict(paper().claims[0], findings).words == "holds, but not for ACTSEL as written"


def test_a_difference_that_may_be_chance_is_called_so() -> None:
    """A claim that holds on average, but not beyond chance, is not told as if it did."""
    verdict = Verdict(paper().claims[0], {"exact": Finding(True, "", chance=True)})
    assert verdict.words == "holds; may be chance for exact"


def test_claims_about_what_was_not_run_are_left_out() -> None:
    """Only claims whose objectives are in the table are checked."""
    found = verdicts(STEPS, paper().claims)
    assert {name for verdict in found for name in verdict.claim.objectives} == {"category"}


def test_every_claim_of_the_paper_can_be_checked() -> None:
    """Its kind is known, and its objectives are the paper's."""
    for claim in paper().claims:
        assert claim.kind in CHECKS
        assert set(claim.objectives) <= set(paper().objectives)
