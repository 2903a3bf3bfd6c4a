"""The paper's experiment in small: rows, tables and report."""

from pathlib import Path

import numpy as np
import pytest

from palpate import EvidenceError, ExactBelief, Learn, Network, explore, load_network
from palpate.experiments.engines import PRESETS, Engine, Exact, MessagePassing
from palpate.experiments.reproduction.claims import verdicts
from palpate.experiments.reproduction.paper import paper
from palpate.experiments.reproduction.plan import plan
from palpate.experiments.reproduction.report import claims_table, report
from palpate.experiments.reproduction.tables import BELIEFS, STEPS, read_table, save_tables
from palpate.experiments.reproduction.tasks import GREEDY, RANDOM, START, TapeTask
from palpate.experiments.running import run_tasks, settings_of
from palpate.experiments.tapes import TapeRobot
from palpate.experiments.workers import executor
from palpate.figures.reproduction import draw_reproduction
from tests.experiments.recordings import write_recordings

OBJECTS = ["wineglass_ycb", "stiff_yellow_sponge"]
ENGINES: list[Engine] = [MessagePassing(PRESETS["as-released"]), Exact()]


@pytest.fixture(scope="module")
def folder(household: Network, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A finished run of two objects by two engines, in a network and another one beside."""
    found = tmp_path_factory.mktemp("reproduction") / "run"
    planned = plan([household, load_network("household")], ENGINES, seed=1, repetitions=1, objects=OBJECTS)
    run_tasks(planned.tasks, found, settings=planned.settings)
    save_tables(found)
    return found


def test_there_is_a_row_for_every_step(folder: Path) -> None:
    """Each network, engine, arm, objective, object and repetition has a run of all five actions."""
    steps = read_table(folder, STEPS)
    assert len(steps.rows(steps["arm"] != START)) == 2 * 2 * 2 * 7 * len(OBJECTS) * 6
    for name in steps.unique("network"):
        own = steps.where(network=name, engine="exact", arm=GREEDY, objective="material", object="wineglass_ycb")
        assert own["step"].tolist() == list(range(6))


def test_rows_are_those_of_an_exploration(folder: Path, household: Network) -> None:
    """Actions, gains and entropies are what exploring the same tape gives, step by step."""
    (task, _) = plan([household], [Exact()], seed=1, repetitions=1, objects=OBJECTS).tasks
    assert isinstance(task, TapeTask)
    rows = read_table(folder, STEPS).where(
        network=household.name, engine="exact", arm=GREEDY, objective="material", object=task.tape.object, stopped=False
    )
    steps = list(explore(ExactBelief(household), TapeRobot(task.tape), objective=Learn("material")))
    assert rows["action"].tolist() == [None, *(step.action for step in steps[:-1])]
    for row, step in enumerate(steps[:-1], start=1):
        assert rows["expected_gain_bits"][row] == pytest.approx(step.expected_gain_bits, abs=1e-9)
        assert rows["realised_gain_bits"][row] == pytest.approx(step.realised_gain_bits, abs=1e-7)
        assert rows["entropy_drop_bits"][row] == pytest.approx(step.entropy_drop_bits, abs=1e-9)
        assert rows["entropy_material_bits"][row] == pytest.approx(step.after.marginal("material").entropy_bits)
    assert rows["stop"].tolist()[-1] == steps[-1].stop


def test_the_equations_are_asked_though_not_run(folder: Path) -> None:
    """As written, a squeeze is expected to lose information on elasticity; the claims say so with its figure."""
    steps = read_table(folder, STEPS).where(network="household-filled")
    verdict = next(v for v in verdicts(steps, paper().claims) if v.claim.kind == "no-negative-gain")
    assert "squeezing on elasticity -0.1" in verdict.findings["as-written"].figure
    assert "weighing on density -0.2" in verdict.findings["as-written"].figure
    assert verdict.findings["as-released"].holds
    assert "not run" in claims_table(verdicts(steps, paper().claims))


def test_random_orders_are_paired(folder: Path) -> None:
    """Random choices are the same for every engine and objective."""
    steps = read_table(folder, STEPS)
    for thing in OBJECTS:
        own = steps.where(arm=RANDOM, object=thing, network=steps.unique("network")[0])
        assert all(len(own.where(step=step).unique("action")) == 1 for step in range(1, 6))


def test_what_is_unknown_is_not_scored(folder: Path) -> None:
    """A sponge's category is a stand-in: it has no cross-entropy; its material has one."""
    steps = read_table(folder, STEPS).where(object="stiff_yellow_sponge")
    assert np.isnan(steps["cross_entropy_category_bits"].astype(float)).all()
    assert all(value >= 0 for value in steps["cross_entropy_material_bits"].astype(float))


def test_beliefs_that_are_drawn_are_in_a_table_of_their_own(folder: Path) -> None:
    """Probabilities of states sum to one, and curves have points."""
    beliefs = read_table(folder, BELIEFS).where(engine="exact", network="household-filled")
    states = beliefs.where(object="wineglass_ycb", objective="category")
    assert states["value"].sum() == pytest.approx(1)
    curve = beliefs.where(object="stiff_yellow_sponge", objective="elasticity")
    assert len(curve) > 20
    assert (curve["value"] >= 0).all()


def test_workers_change_nothing(folder: Path, household: Network, tmp_path: Path) -> None:
    """What two processes do is what one did, byte for byte."""
    planned = plan([household], ENGINES, seed=1, repetitions=1, objects=OBJECTS[:1])
    with executor(2) as workers:
        run_tasks(planned.tasks, tmp_path, workers, settings=planned.settings)
    for task in planned.tasks:
        part = Path("parts") / f"{task.key}.parquet"
        assert (tmp_path / part).read_bytes() == (folder / part).read_bytes()


def test_the_report_holds_claims_figures_and_settings(folder: Path, tmp_path: Path) -> None:
    """Everything that a reader needs is in the report, drawn and told from the saved tables alone."""
    steps, beliefs = read_table(folder, STEPS), read_table(folder, BELIEFS)
    main = steps.unique("network")[0]
    pictures = draw_reproduction(steps.where(network=main), beliefs.where(network=main), paper(), tmp_path)
    text = report(steps, paper(), pictures, settings_of(folder))
    assert all(claim.text in text for claim in paper().claims)
    assert "## The claims with network `household`" in text
    assert "favoured by construction" in text
    assert "Seed 1" in text
    assert len(pictures) == 5
    for path in pictures.values():
        assert f"({path.name})" in text
        assert path.stat().st_size > 10_000


def test_recordings_are_run_with_their_gaps(household: Network, tmp_path: Path) -> None:
    """A folder of recordings runs, and its problems stand in the report."""
    recordings = write_recordings(tmp_path / "data")
    (recordings / "experiment_banana" / "density_0" / "data" / "measurement.json").write_text("{")
    planned = plan([household], [Exact()], seed=0, objectives=["category"], data=recordings)
    assert len(planned.problems) == 1
    run_tasks(planned.tasks, tmp_path / "run", settings=planned.settings)
    save_tables(tmp_path / "run")
    steps = read_table(tmp_path / "run", STEPS)
    assert len(steps) == 2 * 2 * 5 * 6 - 2
    text = report(steps, paper(), {}, settings_of(tmp_path / "run"))
    assert planned.problems[0] in text
    assert "favoured by construction" not in text


def test_a_plan_of_what_is_not_there_is_refused(household: Network) -> None:
    """Unknown objects and objectives are one sentence with what is valid."""
    with pytest.raises(EvidenceError, match=r"did you mean 'banana'"):
        plan([household], ENGINES, seed=0, objects=["bananna"])
    with pytest.raises(EvidenceError, match="unknown objective 'colour'"):
        plan([household], ENGINES, seed=0, objectives=["colour"])
