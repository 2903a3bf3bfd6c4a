"""What the examples of the documentation import is what a user has."""

import ast
import re
import sys
import tomllib
from collections.abc import Iterator
from importlib.metadata import packages_distributions
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
BLOCK = re.compile(r"^```python\n(.*?)^```", re.DOTALL | re.MULTILINE)
FOR_TESTS = {"fastapi.testclient", "starlette.testclient"}
"""They are installed with what they belong to, and need more than that."""
OTHERS = {"export.md": {"duckdb"}}
"""Programs of others that a page is about."""


def imported(page: Path) -> Iterator[str]:
    """Modules that the examples of a page import."""
    for block in BLOCK.findall(page.read_text(encoding="utf-8")):
        for part in ast.walk(ast.parse(block)):
            if isinstance(part, ast.Import):
                yield from (name.name for name in part.names)
            if isinstance(part, ast.ImportFrom):
                yield part.module or ""


def installable() -> set[str]:
    """Names of what is installed with the package or one of its extras."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    lists = [project["dependencies"], *project["optional-dependencies"].values()]
    return {re.split(r"[\[<>=]", text)[0].lower() for texts in lists for text in texts}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_examples_run_with_what_a_user_installs(page: Path) -> None:
    """They import Python's own library, the package, and what its extras install, and nothing that tests need."""
    known, there = packages_distributions(), installable()
    for module in set(imported(page)) - OTHERS.get(page.name, set()):
        top = module.partition(".")[0]
        names = {name.lower() for name in known.get(top, [])}
        assert module not in FOR_TESTS, module
        assert top == "palpate" or top in sys.stdlib_module_names or names & there, module
