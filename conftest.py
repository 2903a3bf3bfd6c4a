"""How tests run; and the examples of the README and of the documentation run as tests.

Each page is one story that runs from top to bottom in one namespace and in an empty folder:
``python`` blocks are executed, ``toml`` blocks are written to the file that their first line names
(``# file: NAME``), ``json`` blocks to ``evidence.json``, and the ``$ palpate ...`` lines of ``console``
blocks must succeed.
"""

import os
import shlex
from collections.abc import Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import pytest
from hypothesis import settings
from sybil import Example, Sybil
from sybil.parsers.markdown import CodeBlockParser, PythonCodeBlockParser
from threadpoolctl import threadpool_limits

from palpate.cli import main

# What is worked out once is kept, and sums of two threads differ from those of one in their last digits.
assert np.__version__, "only libraries that are loaded can be limited"
threadpool_limits(1)

# A busy machine does not break a law, and continuous integration tries the same examples each time.
settings.register_profile("palpate", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("palpate")


@pytest.fixture(scope="session")
def drawing() -> None:
    """Skip where nothing can be drawn without a screen, as the bench's camera needs it."""
    from palpate.robots.mujoco.camera import Camera
    from palpate.robots.mujoco.errors import BenchError
    from palpate.robots.mujoco.scene import Scene

    with Camera(Scene(None), (64, 48)) as camera:
        try:
            camera.image()
        except BenchError as error:
            pytest.skip(f"no way to draw without a screen: {error}")


def start_page(namespace: dict[str, Any]) -> None:
    namespace["_home"] = Path.cwd()
    namespace["_folder"] = TemporaryDirectory()
    os.chdir(namespace["_folder"].name)
    # what an example records is none of the user's
    os.environ["PALPATE_SPOOL"] = str(Path.cwd() / "spool")


def end_page(namespace: Mapping[str, Any]) -> None:
    os.chdir(namespace["_home"])
    del os.environ["PALPATE_SPOOL"]
    namespace["_folder"].cleanup()


def write_network(example: Example) -> None:
    first, _, text = example.parsed.partition("\n")
    Path(first.removeprefix("# file: ")).write_text(text, encoding="utf-8")


def write_evidence(example: Example) -> None:
    Path("evidence.json").write_text(example.parsed, encoding="utf-8")


def run_commands(example: Example) -> None:
    for line in example.parsed.splitlines():
        if line.startswith("$ palpate "):
            with pytest.raises(SystemExit) as stopped:
                main(shlex.split(line, comments=True)[2:])
            assert not stopped.value.code, f"exit code {stopped.value.code} of {line}"


pytest_collect_file = Sybil(
    parsers=[
        PythonCodeBlockParser(),
        CodeBlockParser("toml", write_network),
        CodeBlockParser("json", write_evidence),
        CodeBlockParser("console", run_commands),
    ],
    patterns=["README.md", "docs/*.md"],
    setup=start_page,
    teardown=end_page,
).pytest()
