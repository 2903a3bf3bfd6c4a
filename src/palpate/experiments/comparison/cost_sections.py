"""Sections of the report about paths: how soon, at what cost, and when to stop."""

from __future__ import annotations

import numpy as np

from palpate.experiments.comparison import cost_findings
from palpate.experiments.comparison.plan import IN_MODEL
from palpate.experiments.comparison.results import Results
from palpate.experiments.comparison.sections import methods_of, own_methods_of
from palpate.markdown import Cell, table

__all__ = ["PRICES", "gains_section", "regret_section", "stopping_section", "target_section"]

PRICES = (0.0, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Lambda: bits that a second must be worth [bits/s]."""
STOPPING = ("exact-greedy", "exact-per-cost", "actsel", "actsel-best-case")


def target_section(results: Results) -> str:
    """Actions and cost to a target."""
    rows: list[list[Cell]] = []
    for world in (IN_MODEL, "costed"):
        part = results.where(world=world)
        for name in methods_of(part):
            own = part.where(method=name)
            found = cost_findings.reached(own)
            # of sets fixed beforehand each is another beginning, and none is a path
            mean = None if name == "static" else float(np.mean(list(cost_findings.over_time(own).values())))
            rows.append([world, name, 100 * found.share, found.actions, found.cost_s, mean])
    columns = ["world", "method", "reached [%]", "actions until then", "cost until then [s]"]
    shown = table([*columns, "cross-entropy, mean over time [bits]"], rows, digits=2)
    return f"""## How soon, and at what cost

Target: cross-entropy of the truth, mean of the two, at most {cost_findings.TARGET_BITS:g} bits. Where it is never
reached, all actions count. Costs are the network's assumed ones; in the world *costed* they are dealt anew, so that
what tells most at the start costs most.

{shown}"""


def regret_section(results: Results) -> str:
    """What is lost against the optimal adaptive policy."""
    own = results.where(world=IN_MODEL)
    optimum = own.where(method="optimal")
    depth = len(optimum)
    rows: list[list[Cell]] = [["optimal", *optimum.numbers("information_bits").tolist()]]
    for name in ("greedy", "best set", "any set"):
        told = own.where(method=name).numbers("information_bits")
        rows.append([f"regret of {name}", *(optimum.numbers("information_bits") - told).tolist()])
    for name in own_methods_of(own):
        if not np.isnan(own.where(method=name).numbers("information_bits")).all():
            found = cost_findings.regret(own.where(method=name), optimum)
            rows.append([f"regret of {name}", *(f"{mean:.3f} ({low:.3f} to {high:.3f})" for mean, low, high in found)])
    shown = table(["choices", "1 action", *(f"{step} actions" for step in range(2, depth + 1))], rows)
    return f"""## Regret

Information about category and material together [bits] that the optimal adaptive policy gives with so many actions,
and how much less others give. By enumeration of all outcomes: *greedy*, *best set*, which is fixed beforehand, and
*any set*, the mean over sets. Those of the methods are means over the drawn objects of what exact inference expects on
their paths, with 95 % intervals; they can be below zero by chance.

{shown}"""


def gains_section(results: Results) -> str:
    """Expected against realised gains."""
    own = results.where(world=IN_MODEL)
    rows: list[list[Cell]] = []
    for name in own_methods_of(own):
        part = own.where(method=name)
        if np.isnan(part.numbers("expected_gain_bits")).all():
            continue
        steps = [part.where(step=step) for step in range(1, 6)]
        rows.append([f"{name}: expected", *(p.mean(p.numbers("expected_gain_bits")) for p in steps)])
        rows.append([f"{name}: realised", *(p.mean(p.numbers("realised_gain_bits")) for p in steps)])
    shown = table(["method", *(f"action {step}" for step in range(1, 6))], rows)
    return f"""## Expected and realised gain

In-model, means over objects [bits]. Realised is the fall of the entropy of the method's own belief; of ACTSEL both
are sums over category and material, of the exact engine they are about the two together.

{shown}"""


def stopping_section(results: Results) -> str:
    """Stopping early, late, and by a price."""
    own = results.where(world=IN_MODEL)
    rows: list[list[Cell]] = []
    for name in (n for n in STOPPING if n in methods_of(own)):
        part, rule = own.where(method=name), 0.0 if name.startswith("actsel") else 0.05
        rows.append([name, f"best gain <= {rule:g} bits", *_figures(part, "best_gain_bits", rule)])
        rows += [[name, f"lambda = {price:g} bits/s", *_figures(part, "worth_bits_per_s", price)] for price in PRICES]
    columns = ["method", "stops when", "actions", "cost [s]", "cross-entropy [bits]", "right [%]", "premature [%]"]
    return f"""## Stopping

In-model. First each method's own rule, then: stop when no gain less lambda x cost is above zero. *Right*: the most
probable category and material were, when it stopped. *Premature*: they were not, though further actions of the same
method would have made them right for good. *Wasted*: actions after they were right for good.

{table([*columns, "wasted actions"], rows, digits=2)}"""


def _figures(part: Results, column: str, threshold: float) -> tuple[float, ...]:
    found = cost_findings.stopped(part, column, threshold)
    shares = 100 * found.right, 100 * found.premature
    return found.actions, found.cost_s, found.cross_entropy_bits, *shares, found.wasted
