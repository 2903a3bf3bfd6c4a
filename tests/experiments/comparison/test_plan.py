"""The tasks of a comparison cover all objects of all worlds once."""

from palpate.experiments.comparison.calibration import CalibrationTask
from palpate.experiments.comparison.contest import ContestTask
from palpate.experiments.comparison.plan import FULL, QUICK, calibration_tasks, comparison_tasks
from palpate.experiments.comparison.worlds import worlds


def test_every_object_is_in_one_task() -> None:
    """In each world the tasks' objects are all of them, in order, each once."""
    for size in (QUICK, FULL):
        tasks = comparison_tasks(size, seed=0)
        assert len({task.key for task in tasks}) == len(tasks)
        for world in worlds():
            own = [task for task in tasks if isinstance(task, ContestTask) and task.world == world]
            covered = [i for task in own for i in range(task.start, task.stop)]
            assert covered == list(range(own[0].count))


def test_the_primary_world_is_as_large_as_was_fixed() -> None:
    """The full comparison draws 300 objects in-model and takes the known objects five times."""
    own = [task for task in comparison_tasks(FULL, seed=0) if isinstance(task, ContestTask)]
    assert {task.count for task in own if task.world.name == "in-model"} == {300}
    assert {task.repetitions for task in own if task.world.known_objects} == {5}


def test_a_calibration_covers_all_objects() -> None:
    """Tasks of some hundred objects, the last one smaller."""
    tasks = [task for task in calibration_tasks(1200, seed=0) if isinstance(task, CalibrationTask)]
    assert [(task.start, task.stop) for task in tasks] == [(0, 500), (500, 1000), (1000, 1200)]
