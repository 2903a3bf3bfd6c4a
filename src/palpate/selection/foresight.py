"""The information that several actions give together: adaptively, or as a set fixed beforehand.

Where outcomes are independent given the categorical properties and the objective is categorical or
everything, all outcomes of a plan are worked out as one table; else the plan is walked belief by belief.
"""

from __future__ import annotations

from collections.abc import Sequence

from palpate.errors import EvidenceError
from palpate.inference.belief import Belief
from palpate.inference.exact import ExactBelief
from palpate.selection.objectives import Objective
from palpate.selection.purse import Purse
from palpate.selection.tabled import Tabled
from palpate.selection.walked import Walked

__all__ = ["Tabled", "Walked", "foresight"]


def foresight(
    belief: Belief, objective: Objective, actions: Sequence[str], repeat: bool, purse: Purse | None = None
) -> Tabled | Walked:
    """What works out the value of plans made of these actions.

    Parameters
    ----------
    purse
        What the actions of a plan may cost together; without limit unless given.

    Raises
    ------
    EvidenceError
        If the belief is not exact: other engines have no probabilities of outcomes.
    """
    if not isinstance(belief, ExactBelief):
        raise EvidenceError(f"looking ahead needs the exact engine, found {type(belief).__name__}")
    if not repeat and Tabled.fits(belief, objective, actions):
        return Tabled(belief, objective, actions, purse)
    return Walked(belief, objective, actions, repeat, purse)
