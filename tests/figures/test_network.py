"""The picture of a network."""

from pathlib import Path

import pytest

from palpate.figures.network import draw_network
from palpate.network.reading import load_network


@pytest.mark.parametrize(("name", "suffix"), [("household", "svg"), ("pantry", "svg"), ("household", "png")])
def test_picture_shows_every_property_and_action(name: str, suffix: str, tmp_path: Path) -> None:
    """A picture is written in the format of its suffix; as SVG it holds every name."""
    network = load_network(name)
    path = tmp_path / f"network.{suffix}"
    draw_network(network, path)
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG" if suffix == "png" else b"<?xml")
    if suffix == "svg":
        assert all(f"<!-- {part}" in data.decode() for part in (*network.properties, *network.actions))
