"""An exploration that is killed."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from palpate.recording import Spool
from palpate.store.keeping_episodes import get_episode
from palpate.store.listing_episodes import list_episodes
from palpate.store.opening import open_store
from palpate.store.verifying import verify

PROGRAM = """
import sys
import palpate
from palpate.episode.keeping import KeptEpisode
from palpate.recording import Spool
from palpate.robots.recorded import RecordedRobot
from palpate.selection.stopping import StepBudget
from palpate.store.opening import open_store
from palpate.store.records import ThingRef

network = palpate.load_network("household")
belief = palpate.ExactBelief(network)
own = palpate.FunctionRobot({"weighing": lambda: palpate.Reading(118.0), "squeezing": lambda: palpate.Above(95.0)})
with open_store(sys.argv[1]) as store:
    robot = RecordedRobot(own, network, store, thing=ThingRef("lab", "mug"), spool=Spool(sys.argv[2]))
    episode = KeptEpisode(store, robot, belief)
    for step in palpate.explore(belief, robot, stopping=StepBudget(500), repeat=True):
        episode.write(step)
        print(step.index, flush=True)
"""


@pytest.mark.parametrize("after_s", [0.0, 0.03, 0.11])
def test_a_killed_exploration_is_kept_until_then(tmp_path: Path, after_s: float) -> None:
    """Each step that was acknowledged is in the store with its recording; nothing is half there, or lost."""
    place, spool = tmp_path / "store.sqlite", tmp_path / "spool"
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM, str(place), str(spool)], stdout=subprocess.PIPE, text=True
    ) as process:
        assert process.stdout is not None
        told = [process.stdout.readline() for _ in range(2)]
        time.sleep(after_s)
        process.send_signal(signal.SIGKILL)
        told += process.stdout.readlines()
    acknowledged = max(int(line) for line in told if line.endswith("\n"))
    with open_store(place) as store:
        assert list(verify(store)) == []
        (row,) = list_episodes(store).rows
        steps = get_episode(store, row.id).steps
        assert row.stop is None
        assert acknowledged <= len(steps) <= acknowledged + 1
        assert all(store.get(step.recording or "").action == step.record["action"] for step in steps)
        # the action that was cut off, or ended between its recording and its step
        assert len(list(Spool(spool).recover())) <= 1
