"""Counts beside estimated numbers are checked, and change nothing of the model."""

from pathlib import Path

import pytest

from palpate.errors import NetworkError
from palpate.network.digest import digest
from palpate.network.reading import load_network
from palpate.network.reading_counts import TALLIES

TEXT = """
format = "palpate-network/1"
[provenance]
made_from = ["objects.csv"]
[properties.size]
source = "10 objects"
states = ["small", "large"]
counts = [7, 3]
[properties.kind]
states = ["x", "y"]
parents = ["size"]
[properties.kind.given]
small = [0.5, 0.5]
large = [1, 0]
[properties.kind.counts]
small = [4, 3]
large = [3, 0]
[properties.mass]
unit = "g"
family = "normal"
sd = 1
parents = ["size"]
[properties.mass.given]
small = {mean = 1}
large = {mean = 2}
[properties.mass.counts]
small = 7
large = 3
[properties.double]
source = "arithmetic"
unit = "g"
formula = "2 * mass"
[actions.look]
cost_s = 1
[actions.look.sensor]
property = "size"
kind = "confusion"
outcomes = ["little", "big", "huge"]
[actions.look.sensor.given]
small = [1, 0, 0]
large = [0, 0.5, 0.5]
[actions.look.sensor.counts]
small = [7, 0, 0]
large = [0, 2, 1]
[actions.weigh]
cost_s = 1
[actions.weigh.sensor]
property = "mass"
kind = "normal"
sd = 1
counts = {objects = 10, readings = 30}
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "net.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_counts_are_no_part_of_the_model(tmp_path: Path) -> None:
    """A network with counts is the network without them."""
    with_counts = digest(load_network(written(tmp_path, TEXT)))
    lines = TEXT.splitlines()
    kept, skipping = [], False
    for line in lines:
        skipping = line.endswith(".counts]") if line.startswith("[") else skipping
        if not skipping and not line.startswith("counts"):
            kept.append(line)
    assert len(kept) < len(lines) - 8
    assert digest(load_network(written(tmp_path, "\n".join(kept)))) == with_counts


CASES = [
    ("counts = [7, 3]", "counts = [7]", "properties.size.counts: found [7]; expected 2 counts"),
    ("counts = [7, 3]", "counts = 7", "properties.size.counts: found 7; expected 2 counts"),
    ("counts = [7, 3]", "counts = [7, -3]", "whole numbers, zero or above"),
    ("counts = [7, 3]", "counts = [7.0, 3]", "whole numbers, zero or above"),
    ("counts = [7, 3]", "counts = [true, 3]", "whole numbers, zero or above"),
    ("small = [4, 3]\n", "", "properties.kind.counts: found no 'small'"),
    ("small = 7\n", "small = [7]\n", "properties.mass.counts.small: found [7]; expected a count"),
    ("small = [7, 0, 0]", "small = [7, 0]", "actions.look.sensor.counts.small: found [7, 0]; expected 3 counts"),
    ("readings = 30", "readings = -1", "actions.weigh.sensor.counts.readings: found -1"),
    ("readings = 30", "reading = 30", "unknown key 'reading' (did you mean 'readings'?)"),
    ("[provenance]\nmade_from", "provenance = 3\n[x]\ny", "unknown key 'x'"),
    ("[provenance]\nmade_from = [", "provenance = [", "provenance: found ['objects.csv']; expected a table"),
]


@pytest.mark.parametrize(("old", "new", "message"), CASES)
def test_wrong_counts_are_refused(old: str, new: str, message: str, tmp_path: Path) -> None:
    """Counts of another length or kind are an error that names the key."""
    assert old in TEXT
    with pytest.raises(NetworkError) as caught:
        load_network(written(tmp_path, TEXT.replace(old, new)))
    assert message in str(caught.value)


def test_tallies_are_all_valid(tmp_path: Path) -> None:
    """Each count of a sensor of a number may stand alone."""
    for key in TALLIES:
        load_network(written(tmp_path, TEXT.replace("{objects = 10, readings = 30}", f"{{{key} = 3}}")))
