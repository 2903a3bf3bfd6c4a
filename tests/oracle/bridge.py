"""From the oracle's evidence items to the library's outcomes and beliefs."""

from __future__ import annotations

from collections.abc import Sequence

from palpate.inference.exact import ExactBelief
from palpate.network.model import Network
from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading
from tests.oracle.evidence import Item


def outcome(item: Item) -> Outcome:
    """The library's outcome for an item."""
    if "failed" in item:
        return Failed()
    if "label" in item:
        return Label(item["label"])
    if "likelihood" in item:
        return Likelihood(item["likelihood"])
    if "posterior" in item:
        return Posterior(item["posterior"], item.get("training_prior"), item.get("temperature", 1.0))
    if "value" in item:
        return Reading(item["value"], item.get("sd"))
    return Above(item["above"], item.get("sd")) if "above" in item else Below(item["below"], item.get("sd"))


def believe(network: Network, items: Sequence[Item]) -> ExactBelief:
    """The exact belief given the items."""
    belief = ExactBelief(network)
    for item in items:
        belief = belief.update(item["action"], outcome(item))
    return belief
