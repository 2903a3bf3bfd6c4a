"""The lock files pin what the project needs, and what states the version agrees."""

import re
import tomllib
from pathlib import Path

import pytest

import palpate

ROOT = Path(__file__).parents[2]
MARKER = "[a-z_]+ [<>!=]+ '[A-Za-z0-9.]+'"
PIN = re.compile(rf"(?P<name>[a-z0-9-]+)==[0-9][0-9a-z.]*( ; {MARKER}( (and|or) {MARKER})*)?")


def pinned(file: str) -> dict[str, str]:
    """Name to line of a lock file."""
    lines = (ROOT / "requirements" / file).read_text(encoding="utf-8").splitlines()
    found = [PIN.fullmatch(line) for line in lines]
    assert all(found), f"not a plain pin: {[line for line, match in zip(lines, found, strict=True) if not match]}"
    return {match["name"]: line for match, line in zip(found, lines, strict=True) if match}


def wanted(file: str) -> set[str]:
    """Names of what pyproject.toml asks for in the environment of a lock file."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    groups = settings["dependency-groups"]
    # the commands of the README, those of the store among them, run after `make explore`
    lists = [
        settings["project"]["dependencies"],
        settings["project"]["optional-dependencies"]["store"],
        groups["build"],
    ]
    lists += [groups["docs"], groups["dev"]] if file == "dev.txt" else []
    lists += [groups["bench"]] if file == "bench.txt" else []
    texts = [entry for entries in lists for entry in entries if isinstance(entry, str)]
    return {re.split(r"[\[<>=]", text)[0] for text in texts}


@pytest.mark.parametrize("file", ["run.txt", "dev.txt", "bench.txt"])
def test_all_dependencies_are_pinned(file: str) -> None:
    """Each dependency has one exact version, by name alone: no hosts and no paths."""
    assert wanted(file) <= set(pinned(file))


@pytest.mark.parametrize("file", ["dev.txt", "bench.txt"])
def test_lock_files_agree(file: str) -> None:
    """Installing another lock file on top changes no version of what is there."""
    other = pinned(file)
    assert {name: other[name] for name in pinned("run.txt")} == pinned("run.txt")


def test_the_citation_states_the_version() -> None:
    """CITATION.cff cites the version that the package has."""
    assert f"\nversion: {palpate.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_every_extra_that_an_error_names_can_be_installed() -> None:
    """What is said to be missing is told with an extra that there is."""
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    texts = [path.read_text(encoding="utf-8") for path in (ROOT / "src").rglob("*.py")]
    named = {name for text in texts for name in re.findall(r"""\{extra\(["']([^"']+)["']\)\}""", text)}
    assert len(named) > 5
    assert named <= set(extras)
