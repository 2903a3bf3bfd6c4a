"""Targets, stopping, time and regret, on paths made up by hand."""

import pytest

from palpate.experiments.comparison.cost_findings import over_time, reached, regret, stopped
from palpate.experiments.comparison.results import Results
from tests.experiments.made_up import results, row


def path(
    bits: list[float], *, gains: tuple[float | None, ...] = (0.5, 0.1, None), right: tuple[int, ...] = (0, 1, 1)
) -> Results:
    """One object; costs after no, one and two actions are 0, 2 and 5 s."""
    return results(
        [
            row(
                "w", "m", "o0", step,
                kind_cross_entropy_bits=bits[step], best_gain_bits=gains[step], kind_correct=float(right[step]),
            )
            for step in range(3)
        ]
    )  # fmt: skip


def test_a_target_is_reached_at_the_first_step_that_has_it() -> None:
    """2, 0.4, 0.7 bits reach half a bit after one action, which cost 2 s."""
    found = reached(path([2.0, 0.4, 0.7]))
    assert (found.share, found.actions, found.cost_s) == (1, 1, 2)


def test_a_target_never_reached_costs_all_actions() -> None:
    """Where the target is never reached, all actions count."""
    found = reached(path([2.0, 1.4, 0.7]))
    assert (found.share, found.actions, found.cost_s) == (0, 2, 5)


def test_sets_are_weighted_over_their_orders() -> None:
    """One of two orders reaches the target after one action, the other after two."""
    used = {"": (0, 2.0), "a": (1, 0.1), "b": (1, 2.0), "a+b": (2, 0.1)}
    rows = [row("w", "m", "o0", step, used=text, kind_cross_entropy_bits=bits) for text, (step, bits) in used.items()]
    assert reached(results(rows)).actions == 1.5


@pytest.mark.parametrize(
    ("threshold", "actions", "premature", "wasted"), [(0.6, 0, 1, 0), (0.2, 1, 0, 0), (0.05, 2, 0, 1)]
)
def test_stopping(threshold: float, actions: float, premature: float, wasted: float) -> None:
    """Right for good after one action: stopping before is premature, later wastes what came after."""
    found = stopped(path([2.0, 0.4, 0.7]), "best_gain_bits", threshold)
    assert (found.actions, found.premature, found.wasted) == (actions, premature, wasted)
    assert found.cost_s == (0, 2, 5)[int(actions)]


def test_what_is_never_right_is_neither_premature_nor_wasted() -> None:
    """Where the last answer is wrong, no number of actions would have been enough."""
    found = stopped(path([2.0, 0.4, 0.7], right=(0, 1, 0)), "best_gain_bits", 0.2)
    assert (found.premature, found.wasted) == (0, 0)


def test_negative_gains_stop_at_once() -> None:
    """A method whose best gain is negative stops where it is."""
    assert stopped(path([1.0, 1.0, 1.0], gains=(-0.1, 0.5, None)), "best_gain_bits", 0.0).actions == 0


def test_what_is_believed_counts_for_as_long_as_the_next_action_takes() -> None:
    """(2 s x 2 bits + 3 s x 0.5 bits) / 5 s."""
    assert over_time(path([2.0, 0.5, 0.1])) == {"o0": pytest.approx(1.1)}


def test_regret_is_what_the_optimum_tells_more() -> None:
    """The optimum tells 1 and 2 bits, the method 0.75 and 2."""
    rows = [row("in-model", "optimal", "o0", step, information_bits=float(step)) for step in (1, 2)]
    told = {0: 0.0, 1: 0.75, 2: 2.0}
    own = results([row("in-model", "m", "o0", step, information_bits=bits) for step, bits in told.items()])
    assert regret(own, results(rows)) == [(0.25, 0.25, 0.25), (0.0, 0.0, 0.0)]
