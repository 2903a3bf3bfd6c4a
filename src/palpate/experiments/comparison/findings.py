"""What a comparison found: contrasts of methods, fixed beforehand."""

from __future__ import annotations

from palpate.experiments.comparison.plan import IN_MODEL
from palpate.experiments.comparison.results import Results
from palpate.experiments.statistics import Contrast, adjusted, contrast

__all__ = ["PRIMARY", "mean_over_steps", "primary", "secondary", "under_changes", "verdict"]

PRIMARY = ("exact-greedy", "actsel")
BESIDE = ("exact-greedy", "actsel-best-case")
SECONDARY = (
    ("exact-greedy", "actsel-repaired"),
    ("exact-greedy", "actsel-as-written"),
    ("actsel-scored-exact", "actsel"),
    ("exact-greedy", "actsel-scored-exact"),
    ("greedy-scored-actsel", "actsel"),
    ("exact-greedy", "rand-scored-exact"),
    ("actsel", "rand-scored-actsel"),
    ("exact-greedy", "static"),
    ("look-ahead-2", "exact-greedy"),
    ("exact-per-cost", "exact-greedy"),
)
"""What is asked beside the primary contrast, as one family."""
ALPHA = 0.05


def mean_over_steps(results: Results, world: str, method: str) -> dict[str, float]:
    """By object: cross-entropy of the truth [bits], mean of the categorical properties and of all steps."""
    own = results.where(world=world, method=method)
    return own.by_object(own.over_states("cross_entropy_bits"))


def primary(results: Results) -> tuple[Contrast, Contrast]:
    """The one primary contrast, and the same against ACTSEL's best case, which is reported beside it."""
    return _contrast(results, IN_MODEL, *PRIMARY), _contrast(results, IN_MODEL, *BESIDE)


def secondary(results: Results) -> list[Contrast]:
    """The secondary contrasts between methods that were run, with p-values after Holm."""
    there = results.where(world=IN_MODEL).distinct("method")
    pairs = [pair for pair in SECONDARY if set(pair) <= set(there)]
    return adjusted([_contrast(results, IN_MODEL, *pair) for pair in pairs])


def under_changes(results: Results) -> dict[str, tuple[Contrast, Contrast]]:
    """In each world: the primary contrast, and that against the best case; p-values after Holm over all of them."""
    worlds = [world for world in results.distinct("world") if "actsel" in results.where(world=world).distinct("method")]
    found = [_contrast(results, world, *pair) for world in worlds for pair in (PRIMARY, BESIDE)]
    family = adjusted(found)
    return dict(zip(worlds, zip(family[::2], family[1::2], strict=True), strict=True))


def verdict(found: Contrast) -> str:
    """What a contrast says, in one sentence.

    Examples
    --------
    >>> verdict(Contrast("a less b", -0.5, -0.6, -0.4, 0.001, 300))
    'a is lower than b by 0.500 bits (95 % interval 0.400 to 0.600, p = 0.001, 300 objects).'
    """
    first, second = found.name.split(" less ")
    if (found.p if found.adjusted_p is None else found.adjusted_p) >= ALPHA:
        return f"No difference between {first} and {second} was found ({_figures(found, 1)})."
    word, sign = ("lower", -1) if found.mean < 0 else ("higher", 1)
    return f"{first} is {word} than {second} by {abs(found.mean):.3f} bits ({_figures(found, sign)})."


def _figures(found: Contrast, sign: int) -> str:
    low, high = sorted((sign * found.low, sign * found.high))
    after = "" if found.adjusted_p is None else f", {p_words(found.adjusted_p)} after Holm"
    return f"95 % interval {low:.3f} to {high:.3f}, p = {p_words(found.p)}{after}, {found.objects} objects"


def p_words(p: float) -> str:
    """A p-value for people.

    Examples
    --------
    >>> p_words(0.03141), p_words(0.00005)
    ('0.031', '0.00005')
    """
    return f"{p:.2g}" if p >= 1e-3 else f"{p:.5f}".rstrip("0")


def _contrast(results: Results, world: str, first: str, second: str) -> Contrast:
    pair = mean_over_steps(results, world, first), mean_over_steps(results, world, second)
    return contrast(f"{first} less {second}", *pair)
