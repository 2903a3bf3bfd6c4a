"""The documentation names everything that users can use."""

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import pytest
import typer.main

import palpate
from palpate.cli.app import app

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
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


def public(body: list[ast.stmt], path: str) -> Iterator[tuple[str, ast.FunctionDef]]:
    """The public functions of a module or class, and of its public classes, with where they stand."""
    for part in body:
        if isinstance(part, ast.FunctionDef | ast.ClassDef) and not part.name.startswith("_"):
            if isinstance(part, ast.FunctionDef):
                yield f"{path}.{part.name}", part
            else:
                yield from public(part.body, f"{path}.{part.name}")


def raised(function: ast.FunctionDef) -> set[str]:
    """Names of the errors that a function itself raises, but for that of a method without a body."""
    made = (node.exc for node in ast.walk(function) if isinstance(node, ast.Raise))
    names = {one.func.id for one in made if isinstance(one, ast.Call) and isinstance(one.func, ast.Name)}
    return {name for name in names if name.endswith("Error")} - {"NotImplementedError"}


@pytest.mark.parametrize("module", sorted(set(re.findall(r"automodule:: ([\w.]+)", REFERENCE))))
def test_functions_of_the_reference_tell_what_they_raise(module: str) -> None:
    """A public function that raises an error says so."""
    place = (ROOT / "src").joinpath(*module.split("."))
    tree = ast.parse(
        (place / "__init__.py" if place.is_dir() else place.with_suffix(".py")).read_text(encoding="utf-8")
    )
    told = re.compile(r"Raises\n|\w*Error\b|\b[Rr]aises?\b|Refuse")
    silent = [
        f"{name}: {', '.join(sorted(errors))}"
        for name, function in public(tree.body, module)
        if (errors := raised(function)) and not told.search(ast.get_docstring(function) or "")
    ]
    assert not silent
