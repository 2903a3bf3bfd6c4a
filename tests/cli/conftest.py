import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from palpate.cli import main


@dataclass(frozen=True)
class Ran:
    """What a command did."""

    code: int
    out: str
    err: str

    @property
    def refused(self) -> str:
        """The one sentence on standard error; the command did nothing else."""
        assert self.code == 2
        assert self.out == ""
        assert self.err.startswith("palpate: ")
        assert self.err.count("\n") == 1
        return self.err


Run = Callable[..., Ran]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Run:
    """Run the command line in this process."""
    monkeypatch.setenv("COLUMNS", "100")

    def ran(*arguments: object) -> Ran:
        with pytest.raises(SystemExit) as stopped:
            main([str(argument) for argument in arguments])
        printed = capsys.readouterr()
        return Ran(int(stopped.value.code or 0), printed.out, printed.err)

    return ran


@pytest.fixture
def evidence_file(tmp_path: Path) -> Callable[[list[dict[str, Any]]], Path]:
    """Write evidence to a file."""

    def write(evidence: list[dict[str, Any]]) -> Path:
        path = tmp_path / "evidence.json"
        path.write_text(json.dumps({"evidence": evidence}), encoding="utf-8")
        return path

    return write
