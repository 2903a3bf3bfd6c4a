"""Palpate learns the physical properties of an object by choosing which measurement to make next.

Everything a user needs is here, and is imported when it is first used:

>>> import palpate
>>> belief = palpate.ExactBelief(palpate.load_network("household"))
>>> belief = belief.update("cat-vision", palpate.Label("mug"))
>>> round(float(belief.marginal("category").probabilities.sum()), 9)
1.0
"""

from __future__ import annotations

import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from palpate.client import Client
    from palpate.episode import read_episode
    from palpate.errors import EvidenceError, ImpossibleEvidenceError, LogError, NetworkError, PalpateError
    from palpate.explore import Step, explore
    from palpate.inference.belief import Belief, Observation
    from palpate.inference.exact import ExactBelief
    from palpate.inference.message_passing import MessagePassingBelief
    from palpate.many import explore_many
    from palpate.network.model import Action, KnownObject, Network, TrueValue
    from palpate.network.reading import load_network
    from palpate.network.sensors import ConfusionSensor, NumberSensor
    from palpate.outcomes import Above, Below, Failed, Label, Likelihood, Outcome, Posterior, Reading
    from palpate.robots.protocol import FunctionRobot, Robot
    from palpate.robots.replay import ReplayRobot
    from palpate.robots.sampled import SampledRobot
    from palpate.robots.session import read_session, shipped_session
    from palpate.selection.lookahead import LookAhead
    from palpate.selection.objectives import Everything, Learn, Weighted
    from palpate.selection.policies import FixedOrder, Greedy, GreedyPerCost, Random
    from palpate.selection.static import StaticSet
    from palpate.selection.stopping import (
        CostBudget,
        EntropyBelow,
        GainBelow,
        NetGainBelow,
        NothingLeft,
        SdBelow,
        StepBudget,
    )

__all__ = [
    "Above",
    "Action",
    "Belief",
    "Below",
    "Client",
    "ConfusionSensor",
    "CostBudget",
    "EntropyBelow",
    "Everything",
    "EvidenceError",
    "ExactBelief",
    "Failed",
    "FixedOrder",
    "FunctionRobot",
    "GainBelow",
    "Greedy",
    "GreedyPerCost",
    "ImpossibleEvidenceError",
    "KnownObject",
    "Label",
    "Learn",
    "Likelihood",
    "LogError",
    "LookAhead",
    "MessagePassingBelief",
    "NetGainBelow",
    "Network",
    "NetworkError",
    "NothingLeft",
    "NumberSensor",
    "Observation",
    "Outcome",
    "PalpateError",
    "Posterior",
    "Random",
    "Reading",
    "ReplayRobot",
    "Robot",
    "SampledRobot",
    "SdBelow",
    "StaticSet",
    "Step",
    "StepBudget",
    "TrueValue",
    "Weighted",
    "__version__",
    "explore",
    "explore_many",
    "load_network",
    "read_episode",
    "read_session",
    "shipped_session",
]

__version__ = "0.1.0"

_HOMES = {
    "client": ("Client",),
    "episode": ("read_episode",),
    "errors": ("EvidenceError", "ImpossibleEvidenceError", "LogError", "NetworkError", "PalpateError"),
    "explore": ("Step", "explore"),
    "inference.belief": ("Belief", "Observation"),
    "inference.exact": ("ExactBelief",),
    "inference.message_passing": ("MessagePassingBelief",),
    "many": ("explore_many",),
    "network.model": ("Action", "KnownObject", "Network", "TrueValue"),
    "network.reading": ("load_network",),
    "network.sensors": ("ConfusionSensor", "NumberSensor"),
    "outcomes": ("Above", "Below", "Failed", "Label", "Likelihood", "Outcome", "Posterior", "Reading"),
    "robots.protocol": ("FunctionRobot", "Robot"),
    "robots.replay": ("ReplayRobot",),
    "robots.sampled": ("SampledRobot",),
    "robots.session": ("read_session", "shipped_session"),
    "selection.lookahead": ("LookAhead",),
    "selection.objectives": ("Everything", "Learn", "Weighted"),
    "selection.policies": ("FixedOrder", "Greedy", "GreedyPerCost", "Random"),
    "selection.static": ("StaticSet",),
    "selection.stopping": (
        "CostBudget",
        "EntropyBelow",
        "GainBelow",
        "NetGainBelow",
        "NothingLeft",
        "SdBelow",
        "StepBudget",
    ),
}
_HOME = {name: f"{__name__}.{module}" for module, names in _HOMES.items() for name in names}


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOME[name]), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})


class _Package(ModuleType):
    """The package: `palpate.explore` is the function, whoever imports the module of that name."""

    def __setattr__(self, name: str, value: object) -> None:
        # importing a module of the package sets it here, where it would hide the function
        if not (name in _HOME and isinstance(value, ModuleType)):
            super().__setattr__(name, value)


sys.modules[__name__].__class__ = _Package
