"""Recordings in the published layout: read, shuffled, and their gaps told one by one."""

from pathlib import Path

import pytest

from palpate import ExactBelief, Network, PalpateError, Posterior, Reading
from palpate.experiments.published import published_tapes
from tests.experiments.recordings import content, write, write_recordings


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return write_recordings(tmp_path)


def test_a_whole_folder_has_no_problem(household: Network, folder: Path) -> None:
    """Each object has its tapes, with an outcome of each action that a belief can use."""
    tapes, problems = published_tapes(folder, household, 5, seed=0)
    assert problems == ()
    assert [(tape.object, tape.repetition) for tape in tapes] == [
        (name, repetition) for name in ("banana", "ceramic_mug") for repetition in range(5)
    ]
    belief = ExactBelief(household)
    for action, outcome in tapes[5].outcomes.items():
        belief = belief.update(action, outcome)
    assert list(tapes[5].outcomes) == list(household.actions)
    assert belief.probabilities("category").argmax() == household.categorical[0].states.index("mug")


def test_each_measurement_is_used_once(household: Network, folder: Path) -> None:
    """Over the repetitions each action's five measurements come once, in an order of the seed."""

    def orders(seed: int) -> list[tuple[float, ...]]:
        tapes, _ = published_tapes(folder, household, 5, seed)
        return [
            tuple(getattr(tape.outcomes[action], "value", 0.0) for tape in tapes[5:])
            for action in ("weighing", "squeezing")
        ]

    weighed, squeezed = orders(0)
    assert sorted(weighed) == [325.0, 326.0, 327.0, 328.0, 329.0]
    assert sorted(squeezed) == [140.0, 141.0, 142.0, 143.0, 144.0]
    assert orders(0) == [weighed, squeezed] != orders(1)


def test_outcomes_are_what_the_files_say(household: Network, tmp_path: Path) -> None:
    """Probabilities stay as they are, plastic splits evenly, grams are averaged."""
    for entry in ("mat-vision", "density"):
        for number in range(5):
            write(tmp_path, "ceramic_mug", entry, number, content(entry, 0))
    tape = published_tapes(tmp_path, household, 1, seed=0)[0][0]
    assert tape.outcomes == {
        "mat-vision": Posterior({"ceramic": 0.3, "water": 0.2, "soft-plastic": 0.25, "hard-plastic": 0.25}),
        "weighing": Reading(325.0, unit="g"),
    }


def test_samples_may_stand_in_values(household: Network, tmp_path: Path) -> None:
    """Some files hold the grams in `values` itself."""
    for number in range(5):
        write(tmp_path, "banana", "density", number, {"meas_prop": "density", "values": [118.0, 122.0]})
    assert published_tapes(tmp_path, household, 1, seed=0)[0][0].outcomes["weighing"] == Reading(120.0, unit="g")


@pytest.mark.parametrize(
    ("entry", "found", "said"),
    [
        ("mat-sound", "{", "no readable JSON"),
        ("mat-sound", [1], "meas_prop None was found, expected 'mat-sound'"),
        ("mat-sound", {"meas_prop": "cat-vision"}, "meas_prop 'cat-vision' was found"),
        ("mat-sound", {"meas_prop": "mat-sound"}, "no probabilities were found"),
        ("mat-sound", {"meas_prop": "mat-sound", "values": {"glass": "1"}}, "probability of 'glass' '1' was found"),
        ("density", {"meas_prop": "density", "values": {"arm": {}}}, "no list of samples was found"),
        ("density", {"meas_prop": "density", "values": [1.0, None]}, "a sample None was found"),
        ("elasticity", '{"meas_prop": "elasticity", "params": {"mean": NaN}}', "params.mean nan was found"),
    ],
)
def test_a_broken_file_is_told_and_the_rest_runs(
    household: Network, folder: Path, entry: str, found: object, said: str
) -> None:
    """A problem names its file, and one repetition lacks the action."""
    file = write(folder, "banana", entry, 2, found)
    tapes, (problem,) = published_tapes(folder, household, 5, seed=0)
    assert problem.startswith(f"{file}: ")
    assert said in problem
    assert sorted(len(tape.outcomes) for tape in tapes) == [4, *[5] * 9]


def test_gaps_and_strangers_are_told(household: Network, folder: Path) -> None:
    """A missing file, an unknown entry and an unknown object are told; the object is not scored."""
    (folder / "experiment_banana" / "density_4" / "data" / "measurement.json").unlink()
    (folder / "experiment_banana" / "cat-visoin_0").mkdir()
    write_recordings(folder, ("bananna",))
    tapes, problems = published_tapes(folder, household, 1, seed=0)
    assert [("cannot be read" in p, "'cat-vision'" in p, "did you mean 'banana'" in p) for p in problems] == [
        (False, True, False),
        (True, False, False),
        (False, False, True),
    ]
    assert next(tape for tape in tapes if tape.object == "bananna").truth == {}


def test_what_cannot_be_run_is_one_sentence(household: Network, folder: Path, tmp_path: Path) -> None:
    """A folder without experiments, and more repetitions than there are measurements."""
    with pytest.raises(PalpateError, match="no folder experiment_<object> was found"):
        published_tapes(tmp_path / "nothing", household, 1, seed=0)
    with pytest.raises(PalpateError, match="expected at most 5"):
        published_tapes(folder, household, 6, seed=0)
