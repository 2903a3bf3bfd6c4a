"""What the paper did and what it says: its objectives, case studies, figures and claims, read from TOML."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

__all__ = ["Case", "Claim", "Paper", "paper"]


@dataclass(frozen=True)
class Claim:
    """Something that the paper says of its results.

    Parameters
    ----------
    kind
        How it is checked: one of `palpate.experiments.reproduction.claims.CHECKS`.
    action
        The action it is about; empty where it is about none.
    """

    kind: str
    objectives: tuple[str, ...]
    text: str
    action: str = ""


@dataclass(frozen=True)
class Case:
    """An object and what is learned about it, shown run by run."""

    object: str
    objective: str


@dataclass(frozen=True)
class Paper:
    """The experiments of a paper.

    Parameters
    ----------
    network
        Name of the network that tapes are drawn from and that is believed.
    published_network
        The one with the published figures alone, reported beside.
    objectives
        Name to its properties; of several the gains are summed.
    figure_actions, figure_entropy, figure_cross_entropy
        The objectives whose action counts, entropy and cross-entropy are drawn.
    """

    network: str
    published_network: str
    repetitions: int
    objectives: Mapping[str, tuple[str, ...]]
    cases: tuple[Case, ...]
    claims: tuple[Claim, ...]
    figure_actions: tuple[str, ...]
    figure_entropy: str
    figure_cross_entropy: tuple[str, ...]


@cache
def paper() -> Paper:
    """The paper that ships: Kruzliak et al., IROS 2024.

    Examples
    --------
    >>> len(paper().objectives), paper().cases[0].object
    (7, 'wineglass_ycb')
    """
    found = tomllib.loads(files("palpate").joinpath("data", "experiments", "paper.toml").read_text(encoding="utf-8"))
    figures = found["figures"]
    return Paper(
        network=found["network"],
        published_network=found["published_network"],
        repetitions=found["repetitions"],
        objectives={name: tuple(properties) for name, properties in found["objectives"].items()},
        cases=tuple(Case(**case) for case in found["cases"]),
        claims=tuple(Claim(**{**claim, "objectives": tuple(claim["objectives"])}) for claim in found["claims"]),
        figure_actions=tuple(figures["actions"]),
        figure_entropy=figures["entropy"],
        figure_cross_entropy=tuple(figures["cross_entropy"]),
    )
