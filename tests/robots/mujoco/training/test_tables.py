"""Modal tables: plates that differ, and files of measured modes."""

import json
from pathlib import Path

import numpy as np
import pytest

from palpate.errors import PalpateError
from palpate.robots.mujoco.hearing import BEFORE_S, RATE_HZ
from palpate.robots.mujoco.noise import QUIET
from palpate.robots.mujoco.reading import read_substances
from palpate.robots.mujoco.training.tables import WALLS_MM, Measured, draw_plates, read_measured


def write(folder: Path, name: str, first_hz: float = 500.0) -> None:
    modes = 12
    plain = {"cf": [first_hz + 100.0 * n for n in range(modes)], "op": [-40.0] * modes, "rt": [0.1] * modes}
    (folder / f"{name}_mm.json").write_text(json.dumps(plain))


def test_plates_are_of_every_material_and_none_twice() -> None:
    """So many of each material of the file, and no modal table is a copy of another."""
    plates = draw_plates(read_substances(), 5, np.random.default_rng(1))
    assert sorted({plate.label for plate in plates}) == sorted(WALLS_MM)
    assert len(set(plates)) == 40


def test_copies_of_a_table_are_one(tmp_path: Path) -> None:
    """Sizes that share their first ten modes are one table, however they are called; others are no concern."""
    write(tmp_path, "glass_0")
    write(tmp_path, "glass_1")
    write(tmp_path, "Glass_2", 700.0)
    write(tmp_path, "rubber_0")
    found = read_measured(tmp_path)
    assert [table.label for table in found] == ["glass", "glass"]
    assert len(found[0].frequency_hz) == 10


def test_a_measured_mode_falls_by_60_db_in_its_time() -> None:
    """One mode of 0.2 s is a thousandth as strong after that."""
    sound = Measured("glass", (1000.0,), (-40.0,), (0.2,)).sound(QUIET, np.random.default_rng(0))
    start, period = round(BEFORE_S * RATE_HZ), round(RATE_HZ / 1000)
    first, later = (np.abs(sound[at : at + 2 * period]).max() for at in (start, start + round(0.2 * RATE_HZ)))
    assert later / first == pytest.approx(1e-3, rel=0.15)


def test_folders_of_something_else_are_refused(tmp_path: Path) -> None:
    """No tables, and files that are none, are said in one sentence."""
    with pytest.raises(PalpateError, match="no modal tables"):
        read_measured(tmp_path)
    (tmp_path / "glass_0_mm.json").write_text("{}")
    with pytest.raises(PalpateError, match="expected a modal table"):
        read_measured(tmp_path)
