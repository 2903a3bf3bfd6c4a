import json
from pathlib import Path
from typing import Any

import pytest

from palpate.recording.spool import Spool
from palpate.store.entries import Value
from palpate.store.opening import open_store
from palpate.store.records import Recording
from tests.cli.conftest import Run
from tests.store.importing.invented import squeeze


def fluffy(unit: str, **fields: Any) -> Recording:
    return squeeze(entries=(Value("fluff", 42.0, 10.0, unit),), **fields)


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """A store in which one wrong unit came first."""
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        store.put(fluffy("g", action="trying"))
    return tmp_path / "store.sqlite"


def test_what_was_refused_goes_through_once_the_unit_is_right(run: Run, place: Path, tmp_path: Path) -> None:
    """A wrong first unit refuses what is right; a curator takes it back, and what was refused is sent and counts."""
    spool = Spool(tmp_path / "spool", sync=False)
    spool.add(fluffy("kPa"))
    upload = ("spool", "upload", "--spool", spool.folder, "--to", place)
    ran = run(*upload)
    assert ran.code == 1
    assert "expected the dimension that " in ran.out
    assert len(spool.refused()) == 1
    assert "said to be wrong (wrong, --wrong)" in run("store", "unit", "fluff", "kPa", "--store", place).refused
    ran = run("store", "unit", "fluff", "kPa", "--wrong", "--who", "ann", "--store", place)
    assert ran.out == "fluff: kPa decides; 0 results count, 1 in another dimension do not\n"
    ran = run(*upload, "--refused")
    assert (ran.code, spool.waiting(), spool.refused()) == (0, [], {})
    (found,) = json.loads(run("store", "units", "--json", "--store", place).out)
    assert found == {"name": "fluff", "unit": "kPa", "results": 1, "wrong": 1}
    assert run("store", "verify", "--store", place).code == 0
    assert "fluff [kPa]" in run("store", "table", "--store", place).out


def test_units_are_listed(run: Run, place: Path) -> None:
    """Each property with its unit, and how many results do not count."""
    out = run("store", "units", "--store", place).out
    assert out.split() == ["property", "unit", "results", "do", "not", "count", "fluff", "g", "1"]


def test_a_unit_that_cannot_be_is_one_sentence(run: Run, place: Path) -> None:
    """A name that is nearly right comes with the one that was meant; so does a unit that is none with one that is."""
    assert "did you mean 'fluff'" in run("store", "unit", "fluf", "kPa", "--store", place).refused
    assert "unknown unit 'kPascal'" in run("store", "unit", "fluff", "kPascal", "--store", place).refused
