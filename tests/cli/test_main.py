import subprocess
import sys
from typing import Any

import pytest

import palpate
from palpate import cli


def test_version(run: Any) -> None:
    """--version prints the version alone."""
    assert run("--version").out == f"{palpate.__version__}\n"


@pytest.mark.parametrize("command", [[], ["--help"], ["explore", "--help"], ["infer", "--help"], ["network", "--help"]])
def test_help(run: Any, command: list[str]) -> None:
    """Help is printed on standard output and is no error, as is the command without arguments."""
    ran = run(*command)
    assert ran.code == 0
    assert "Usage: palpate" in ran.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["explor"], "No such command 'explor'"),
        (["infer"], "Missing argument 'FILE|-'"),
        (["infer", "--jason", "x"], "No such option: --jason"),
        (["explore", "banana", "--steps", "few"], "--steps"),
        (["explore", "banana", "--robot", "real"], "sampled"),
    ],
)
def test_usage_errors_are_one_sentence(run: Any, arguments: list[str], said: str) -> None:
    """A command that does not exist or is used wrongly is refused in one line that points to the help."""
    refused = run(*arguments).refused
    assert said in refused
    assert "--help" in refused


def test_interrupt(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Ctrl-C ends with the code that shells know, 130, and one line."""

    def interrupted(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("palpate.cli.exploring.explore_object", interrupted)
    ran = run("explore", "banana")
    assert (ran.code, ran.err) == (130, "palpate: interrupted\n")


def test_a_fault_of_the_program_is_not_hidden(monkeypatch: pytest.MonkeyPatch) -> None:
    """Only bad input is one sentence; a fault of palpate itself keeps its traceback."""

    def faulty(*_: object) -> None:
        raise RuntimeError("a fault")

    monkeypatch.setattr("palpate.network.reading.load_network", faulty)
    with pytest.raises(RuntimeError, match="a fault"):
        cli.main(["network", "show"])


def test_the_module_runs_as_a_program() -> None:
    """`python -m palpate` is the same program."""
    found = subprocess.run([sys.executable, "-m", "palpate", "--version"], capture_output=True, text=True, check=True)
    assert found.stdout == f"{palpate.__version__}\n"


def test_infer_imports_only_what_it_needs() -> None:
    """`palpate infer` starts quickly: pint, matplotlib and, for JSON, rich's tables stay away."""
    program = (
        "import sys, io; sys.stdin = io.StringIO('{\"evidence\": []}')\n"
        "from palpate.cli import main\n"
        "try: main(['infer', '-', '--json'])\n"
        "except SystemExit: pass\n"
        "print([m for m in ('pint', 'matplotlib', 'scipy.stats', 'rich.table', 'asyncio') if m in sys.modules])"
    )
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.splitlines()[-1] == "[]"
