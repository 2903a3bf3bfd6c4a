"""Scores as Markdown."""

from __future__ import annotations

import numpy as np

from palpate.robots.mujoco.training.held_out import Scores

__all__ = ["report"]


def report(what: str, found: Scores) -> str:
    """One line of figures, and the confusion matrix in percent: rows are the truth, of states that were met.

    Examples
    --------
    >>> print(report("Coins", Scores(("head", "tail"), np.array([[0.9, 0.1], [0.3, 0.7]]), 0.8, 0.25, 0.0)))
    Coins: balanced accuracy 0.80 (chance 0.50), 0.25 bits over the prior, 0 % failed
    <BLANKLINE>
    | | head | tail |
    |---|---|---|
    | head | 90 | 10 |
    | tail | 30 | 70 |
    """
    chance = 1 / len(found.states)
    lines = [
        f"{what}: balanced accuracy {found.balanced_accuracy:.2f} (chance {chance:.2f}), "
        f"{found.gain_bits:.2f} bits over the prior, {found.failed:.0%} failed".replace("%", " %"),
        "",
        f"| | {' | '.join(found.states)} |",
        f"|---|{'---|' * len(found.states)}",
    ]
    for state, row in zip(found.states, found.confusion, strict=True):
        if np.isfinite(row).all():
            lines.append(f"| {state} | {' | '.join(f'{100 * np.round(share, 2):.0f}' for share in row)} |")
    return "\n".join(lines)
