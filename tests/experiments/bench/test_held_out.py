"""Objects held out one after the other: nothing of them is in the sensors that they are explored with."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.experiments.bench.held_out import (
    CALIBRATED,
    PUBLISHED,
    TOLD,
    ExploreTask,
    PairTask,
    SensorTask,
    by_sensor,
    calibrated_without,
    held_out_tasks,
)
from palpate.experiments.running import Row
from palpate.experiments.shared import SharedNetwork
from palpate.fitting.robot_data import Measured
from palpate.network.digest import digest
from palpate.outcomes import Above, Failed, Label, Outcome, Posterior, Reading
from tests.experiments.bench.made_up import NETWORK, measured

SHARED = SharedNetwork(NETWORK)


def spoilt(thing: str) -> tuple[Measured, ...]:
    """The outcomes, with those of one object replaced by others."""
    wrong: dict[str, Outcome] = {"weighing": Reading(900.0), "squeezing": Reading(1.0), "cat-vision": Label("box")}
    return tuple(
        replace(one, outcome=wrong.get(one.action, Label("paper"))) if one.thing == thing else one for one in measured()
    )


def test_what_is_held_out_does_not_count() -> None:
    """Whatever an object gave, the sensors calibrated without it are the same; with it they are not."""
    without = digest(calibrated_without(NETWORK, measured(), "ceramic_mug"))
    assert digest(calibrated_without(NETWORK, spoilt("ceramic_mug"), "ceramic_mug")) == without
    assert digest(calibrated_without(NETWORK, spoilt("ceramic_mug"), "wineglass")) != digest(
        calibrated_without(NETWORK, measured(), "wineglass")
    )
    assert without != digest(NETWORK)


def test_a_tape_holds_the_nth_outcome_of_each_action() -> None:
    """In the order of the network, with the truth that is scored."""
    tapes = ExploreTask(SHARED, measured(), 0, "banana").tapes()
    own = [one for one in measured() if one.thing == "banana"]
    assert len(tapes) == 3
    for n, tape in enumerate(tapes):
        assert list(tape.outcomes) == list(NETWORK.actions)
        for action, outcome in tape.outcomes.items():
            assert outcome == by_sensor([one.outcome for one in own if one.action == action][n])
    assert "material" not in tapes[0].truth
    assert ExploreTask(SHARED, measured(), 0, "plastic_cup_ycb").tapes() == []


def test_the_sensor_says_how_sure_an_outcome_is() -> None:
    """Vectors become labels, and numbers lose their own SD; failures stay."""
    assert by_sensor(Posterior({"glass": 0.9, "wood": 0.1})) == Label("glass")
    assert by_sensor(Above(95.0, sd=2.0)) == Above(95.0)
    assert by_sensor(Failed("it fell")) == Failed("it fell")


def explored(thing: str) -> list[Row]:
    return ExploreTask(SHARED, measured(), 0, thing).run()


def test_each_world_and_method_has_its_rows() -> None:
    """Greedy takes one way through each tape; random is the mean of all orders, so that weights sum to one."""
    rows = explored("ceramic_mug")
    assert {row["world"] for row in rows} == {CALIBRATED, PUBLISHED, TOLD}
    for world in (CALIBRATED, PUBLISHED, TOLD):
        for method in ("exact-greedy", "rand-scored-exact"):
            for step in range(6):
                own = [
                    row
                    for row in rows
                    if (row["world"], row["method"], row["step"], row["repetition"]) == (world, method, step, 1)
                ]
                assert sum(float(str(row["weight"])) for row in own) == pytest.approx(1.0)
                assert len({tuple(row) for row in own}) == 1


def test_after_all_actions_the_order_is_no_matter() -> None:
    """Greedy and random end in the same belief, and begin with the prior."""
    rows = explored("ceramic_mug")
    for step in (0, 5):
        found = [
            row["material_cross_entropy_bits"]
            for row in rows
            if (row["world"], row["step"], row["repetition"]) == (CALIBRATED, step, 0)
        ]
        assert len(found) == 2
        assert found[0] == pytest.approx(found[1], abs=1e-9)


def test_the_sensors_are_scored_on_the_object() -> None:
    """A mean log2 probability for each sensor whose property is known, calibrated and as published."""
    rows = SensorTask(SHARED, measured(), 0, "banana").run()
    assert [row["method"] for row in rows] == ["cat-vision", "squeezing", "weighing"]
    assert all(np.isfinite(float(str(row["calibrated_log2_p"]))) for row in rows)


def test_there_is_a_task_for_each_object_and_look_alike() -> None:
    """Keys are different, and only the six that look like others, or that others look like, are told from these."""
    tasks = held_out_tasks(NETWORK, measured())
    assert len({task.key for task in tasks}) == len(tasks) == 17 + 17 + 6
    assert {task.thing for task in tasks if isinstance(task, PairTask)} == {
        "banana", "banana_ycb", "soft_yellow_sponge", "stiff_yellow_sponge", "wineglass", "wineglass_ycb",
    }  # fmt: skip
