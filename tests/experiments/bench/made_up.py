"""What a robot would have measured on the known objects, drawn from the network."""

import json
from functools import cache

import palpate
from palpate.evidence import parse_item
from palpate.experiments.measuring import Sampled, measure_tasks
from palpate.experiments.shared import SharedNetwork
from palpate.fitting.robot_data import Measured

NETWORK = palpate.load_network("household-filled")
THINGS = ("banana", "banana_ycb", "ceramic_mug", "enamel_mug_ycb", "wineglass", "wineglass_ycb", "wooden_box_ycb")


@cache
def measured(times: int = 3, seed: int = 1) -> tuple[Measured, ...]:
    """Outcomes of some objects."""
    lab = Sampled(SharedNetwork(NETWORK))
    rows = [row for task in measure_tasks(lab, THINGS, times=times, seed=seed) for row in task.run()]
    found = []
    for row in rows:
        action, outcome = parse_item(json.loads(str(row["outcome"])))
        found.append(Measured(str(row["object"]), action, outcome))
    return tuple(found)
