from pathlib import Path
from typing import Any

import pytest

from palpate.network.reading import load_network, shipped_networks

WRONG = """
format = "palpate-network/1"
[properties.door]
states = ["open", "shut"]
prior = [0.5, 0.6]
"""


@pytest.mark.parametrize("name", shipped_networks())
def test_check_says_what_is_in_a_network(run: Any, name: str) -> None:
    """A valid network is called valid, with what was found in it."""
    network = load_network(name)
    found = run("network", "check", name)
    assert found.code == 0
    assert "is valid" in found.out
    assert f"{len(network.properties)} properties" in found.out
    assert f"{network.joint_states} joint states" in found.out


def test_check_names_what_is_wrong(run: Any, tmp_path: Path) -> None:
    """A wrong network is refused with the file, the key and what was found."""
    path = tmp_path / "wrong.toml"
    path.write_text(WRONG, encoding="utf-8")
    refused = run("network", "check", path).refused
    assert "wrong.toml" in refused
    assert "properties.door" in refused
    assert "1.1" in refused


def test_a_syntax_error_names_file_and_line(run: Any, tmp_path: Path) -> None:
    """TOML that cannot be read is refused with the file and the line."""
    path = tmp_path / "broken.toml"
    path.write_text("format = \n", encoding="utf-8")
    refused = run("network", "check", path).refused
    assert "broken.toml" in refused
    assert "line 1" in refused


@pytest.mark.parametrize("name", shipped_networks())
def test_show_names_everything(run: Any, name: str) -> None:
    """Every property and every action of a network is shown, within 100 columns."""
    network = load_network(name)
    found = run("network", "show", name)
    assert found.code == 0
    assert all(part in found.out for part in (*network.properties, *network.actions))
    assert max(map(len, found.out.splitlines())) <= 100


def test_show_dot_is_graphviz_text(run: Any) -> None:
    """--dot prints the graph alone, to be piped into dot."""
    found = run("network", "show", "--dot")
    assert found.out.startswith("digraph")
    assert found.out.rstrip().endswith("}")


def test_picture(run: Any, tmp_path: Path) -> None:
    """--picture draws the network into a file, and prints nothing."""
    found = run("network", "show", "--picture", tmp_path / "network.svg")
    assert (found.code, found.out) == (0, "")
    assert "<svg" in (tmp_path / "network.svg").read_text(encoding="utf-8")


def test_picture_of_an_unknown_kind(run: Any, tmp_path: Path) -> None:
    """A picture whose ending is of no picture is refused with those that are, and nothing is made."""
    assert "'.png'" in run("network", "show", "--picture", tmp_path / "network.gif").refused
    assert list(tmp_path.iterdir()) == []
