"""Rows of a comparison that no engine has made: quick, and of every kind that the report reads."""

from collections.abc import Iterator

import numpy as np

from palpate.experiments.comparison.findings import PRIMARY
from palpate.experiments.comparison.methods import all_methods
from palpate.experiments.comparison.results import Results
from palpate.experiments.comparison.worlds import worlds
from palpate.experiments.running import Row

ACTIONS = ("a", "b")
COSTS = (0.0, 2.0, 5.0)
NO_GAINS = ("rand-scored-exact", "rand-scored-actsel", "static")


def row(world: str, method: str, thing: str, step: int, **values: object) -> Row:
    """A row of one object after some of two actions."""
    rng = np.random.default_rng([len(world), len(method), int(thing[1:]), step])
    p = rng.dirichlet(np.ones(2))
    truth = int(rng.integers(2))
    found: Row = {
        "world": world,
        "method": method,
        "object": thing,
        "repetition": 0,
        "trick": thing == "o0",
        "step": step,
        "weight": 1.0,
        "used": "+".join(ACTIONS[:step]),
        "cost_s": COSTS[step],
        "kind_cross_entropy_bits": float(-np.log2(p[truth])),
        "kind_brier": 0.5,
        "kind_correct": float(p.argmax() == truth),
        "kind_confidence": float(p.max()),
        "kind_entropy_bits": 0.8,
        "kind_truth": truth,
        "kind_probabilities": p.tolist(),
        "size_crps": float(rng.random()),
        "size_rank": float(rng.random()),
    }
    names = ("expected_gain_bits", "realised_gain_bits", "best_gain_bits", "worth_bits_per_s", "information_bits")
    gains = dict.fromkeys(names, None if method in NO_GAINS else float(rng.random()))
    return found | gains | values


def rows(objects: int = 4) -> Iterator[Row]:
    """Every method in every world, and the optimum."""
    for world in worlds():
        for method in all_methods():
            bias = 0.0 if method.name == PRIMARY[0] else 1.0
            for thing in range(objects):
                for step in range(3):
                    found = row(world.name, method.name, f"o{thing}", step)
                    yield found | {"kind_cross_entropy_bits": bias + 0.1 * thing}
    for method_name in ("optimal", "greedy", "best set", "any set"):
        for step in (1, 2):
            empty = dict.fromkeys(row("in-model", "optimal", "o0", 1))
            about = {"world": "in-model", "method": method_name, "step": step, "weight": 1.0}
            yield empty | about | {"information_bits": float(step)}


def results(found: list[Row]) -> Results:
    """The rows as they are read from a table."""
    import pyarrow as pa

    return Results.read(pa.Table.from_pylist(found))
