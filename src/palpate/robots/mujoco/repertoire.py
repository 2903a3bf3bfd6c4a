"""Which of a network's actions the bench can do, and how."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.knocking import knock
from palpate.robots.mujoco.looking import look
from palpate.robots.mujoco.squeezing import squeeze
from palpate.robots.mujoco.weighing import weigh
from palpate.robots.signals import Signals

__all__ = ["Deed", "repertoire"]

Deed = Callable[[Bench], Signals]
"""What the bench does for an action."""


def repertoire(network: Network, roles: Mapping[str, str]) -> dict[str, Deed]:
    """Find the deed for each action by what it measures.

    Actions that see the appearance look; those that measure mass weigh, those that measure elasticity squeeze, and
    those of other categorical properties knock. An action that measures anything else is left out.

    Parameters
    ----------
    roles
        ``mass`` and ``elasticity`` to the names of these properties in the network.

    Examples
    --------
    >>> from palpate.network.reading import load_network
    >>> deeds = repertoire(load_network("household"), {"mass": "mass", "elasticity": "elasticity"})
    >>> {action: deed.__name__ for action, deed in deeds.items()}
    {'cat-vision': 'look', 'mat-vision': 'look', 'mat-sound': 'knock', 'squeezing': 'squeeze', 'weighing': 'weigh'}
    """
    found: dict[str, Deed] = {}
    for name, action in network.actions.items():
        measured = action.sensor.property
        if action.sees_appearance:
            found[name] = look
        elif measured == roles["mass"]:
            found[name] = weigh
        elif measured == roles["elasticity"]:
            found[name] = squeeze
        elif isinstance(network.properties[measured], CategoricalProperty):
            found[name] = knock
    return found
