"""The documentation names everything that users can use."""

import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer.main

import palpate
from palpate.cli.app import app

DOCS = Path(__file__).parents[2] / "docs"
REFERENCE = "\n".join(page.read_text(encoding="utf-8") for page in sorted((DOCS / "api").glob("*.md")))


def commands(command: object, path: str = "palpate") -> Iterator[tuple[str, list[str]]]:
    """Each command that does something, with its options."""
    inner = getattr(command, "commands", {})
    for name, part in inner.items():
        yield from commands(part, f"{path} {name}")
    if not inner:
        yield path, [name for option in getattr(command, "params", []) for name in option.opts if name[:2] == "--"]


@pytest.mark.parametrize("name", palpate.__all__)
def test_exported_names_are_in_the_reference(name: str) -> None:
    """Every name that the package exports stands in the overview, and its module in the reference."""
    overview = (DOCS / "api" / "index.md").read_text(encoding="utf-8")
    assert f"`{name}`" in overview
    value = getattr(palpate, name)
    if inspect.isclass(value) or inspect.isfunction(value):
        assert f"automodule:: {value.__module__}\n" in REFERENCE


def test_the_overview_names_nothing_else() -> None:
    """Every name of the overview is one that the package exports."""
    table = re.findall(r"^\| (`.*?) \|", (DOCS / "api" / "index.md").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert {name for row in table for name in re.findall(r"`(\w+)`", row)} == set(palpate.__all__)


@pytest.mark.parametrize(("command", "options"), list(commands(typer.main.get_command(app))))
def test_commands_are_documented(command: str, options: list[str]) -> None:
    """Every command and every option stands on the command line's page."""
    page = (DOCS / "command_line.md").read_text(encoding="utf-8")
    assert command in page
    assert not [option for option in options if option not in page]
