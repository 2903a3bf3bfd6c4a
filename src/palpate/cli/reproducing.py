"""What `palpate reproduce` does: plan, run with a bar, draw, and tell the claims in short."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from palpate.cli.reproduce_options import Experiments
from palpate.cli.task_options import Running
from palpate.cli.tasks_view import run_shown
from palpate.cli.terminal import console
from palpate.errors import PalpateError, choices, near
from palpate.experiments.engines import PRESETS, Engine, Exact, MessagePassing
from palpate.experiments.frames import Frame
from palpate.experiments.reproduction.claims import verdicts
from palpate.experiments.reproduction.paper import paper
from palpate.experiments.reproduction.plan import Plan, plan
from palpate.experiments.reproduction.report import report
from palpate.experiments.reproduction.tables import BELIEFS, STEPS, read_table, save_tables
from palpate.experiments.running import settings_of
from palpate.figures.reproduction import draw_reproduction
from palpate.network.reading import load_network
from palpate.wording import plural

__all__ = ["planned", "run", "tell"]

ENGINES = ("message-passing", "exact")
REPORT = "report.md"


def planned(asked: Experiments) -> Plan:
    """The plan of what was asked for."""
    names = _once(asked.network) or [paper().network, paper().published_network]
    return plan(
        [load_network(name) for name in names],
        _engines(_once(asked.engine), _once(asked.preset)),
        seed=asked.seed,
        repetitions=asked.repetitions,
        objects=asked.thing or [],
        objectives=asked.learn or [],
        data=asked.data,
    )


def _once(names: Sequence[str] | None) -> list[str]:
    """The names that were typed, each once, in their order."""
    return list(dict.fromkeys(names or ()))


def _engines(names: Sequence[str], presets: Sequence[str]) -> list[Engine]:
    """The engines by their names; message passing once for each preset."""
    for option, given, valid in (("--engine", names, ENGINES), ("--preset", presets, tuple(PRESETS))):
        for name in given:
            if name not in valid:
                raise PalpateError(f"{option}: unknown {option[2:]} {name!r}{near(name, valid)}; {choices(valid)}")
    if presets and names == ["exact"]:
        raise PalpateError(f"--preset {presets[0]} is only for --engine message-passing, and the engine is exact")
    found: list[Engine] = []
    if not names or "message-passing" in names:
        found += [MessagePassing(PRESETS[name]) for name in presets or ["as-released"]]
    return [*found, Exact()] if not names or "exact" in names else found


def run(planned: Plan, folder: Path, running: Running) -> None:
    """Run the tasks and save the tables."""
    if planned.problems:
        print(f"{plural(len(planned.problems), 'problem')} with the recordings, listed in the report:")
    for problem in planned.problems:
        print(f"  {problem}")
    run_shown(planned.tasks, folder, running, doing="Exploring", settings=planned.settings)
    save_tables(folder)


def tell(folder: Path) -> None:
    """Draw the figures, write the report, and print where all is and what became of the claims."""
    steps, beliefs, known = read_table(folder, STEPS), read_table(folder, BELIEFS), paper()
    main = steps.unique("network")[0]
    own = steps.where(network=main)
    pictures = draw_reproduction(own, beliefs.where(network=main), known, folder)
    text = report(steps, known, pictures, settings_of(folder))
    (folder / REPORT).write_text(text, encoding="utf-8")
    _print_claims(own, main)
    print(f"{folder / REPORT}: all of it, with {plural(len(pictures), 'figure')}; {STEPS} and {BELIEFS} beside it are")
    print("the tables, as Parquet and CSV")


def _print_claims(steps: Frame, network: str) -> None:
    from rich.table import Table

    table = Table("Claim of the paper", "Verdict", title=f"Network {network}", title_justify="left", box=None)
    for verdict in verdicts(steps, paper().claims):
        table.add_row(verdict.claim.text, verdict.words)
    console().print(table)
