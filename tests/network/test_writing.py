"""Tables written as TOML are read as the same tables."""

import tomllib
from datetime import date
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.errors import NetworkError
from palpate.network.digest import digest
from palpate.network.reading import load_network, read_document, shipped_networks
from palpate.network.writing import to_toml

texts = st.text(st.characters(exclude_categories=["Cs"]), max_size=6)
keys = texts | st.sampled_from(["given", "prior", "counts", "sensor", "a.b", ""])
plain = texts | st.booleans() | st.integers(-(2**63), 2**63 - 1) | st.floats(allow_nan=False) | st.dates(date(1, 1, 1))
values = st.recursive(
    plain,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(keys, inner, max_size=3),
    max_leaves=12,
)


@given(st.dictionaries(keys, values, max_size=4))
def test_what_is_written_is_read(tables: dict[str, object]) -> None:
    """Any tables that TOML can hold come back, whatever their keys."""
    assert tomllib.loads(to_toml(tables)) == tables


@pytest.mark.parametrize("name", shipped_networks())
def test_shipped_networks_keep_their_digest(name: str, tmp_path: Path) -> None:
    """A network written whole, with what it extends in it, is the same model."""
    tables = dict(read_document(name).tables)
    tables.pop("extends", None)
    path = tmp_path / "copy.toml"
    path.write_text(to_toml(tables), encoding="utf-8")
    assert digest(load_network(path)) == digest(load_network(name))


def test_a_value_that_toml_has_not() -> None:
    """None is no value of TOML, and the error says so."""
    with pytest.raises(NetworkError, match="found NoneType None; expected what TOML can hold"):
        to_toml({"name": None})
