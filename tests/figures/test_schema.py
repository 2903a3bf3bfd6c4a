"""The picture of a store's tables."""

from pathlib import Path

import pytest

from palpate.figures.schema import PLACES, draw_schema, fingerprint
from palpate.store import schema

DRAWN = Path(__file__).parents[2] / "docs" / "images" / "schema.png"


def test_every_table_has_a_place() -> None:
    """The picture shows each table of the schema once."""
    assert sorted(name for names in PLACES for name in names) == sorted(schema.metadata.tables)


@pytest.mark.parametrize("suffix", ["svg", "png"])
def test_picture_shows_every_column(suffix: str, tmp_path: Path) -> None:
    """A picture is written in the format of its suffix; as SVG it holds every table and column."""
    path = tmp_path / f"schema.{suffix}"
    draw_schema(path)
    data = path.read_bytes()
    assert data.startswith(b"\x89PNG" if suffix == "png" else b"<?xml")
    if suffix == "svg":
        for table in schema.metadata.tables.values():
            assert all(f"<!-- {name} -->" in data.decode() for name in (table.name, *table.columns.keys()))


def test_the_documentation_shows_these_tables() -> None:
    """The picture in the documentation was drawn from the schema as it is: `palpate store schema` draws it again."""
    assert fingerprint().encode() in DRAWN.read_bytes()
