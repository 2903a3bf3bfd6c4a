"""What is exported for those who see some recordings says of objects what they see."""

from pathlib import Path

import polars as pl
import pytest

from palpate.store.archive import Archive
from palpate.store.describing import change_thing
from palpate.store.entries import Value
from palpate.store.exporting.hugging_face import HuggingFace
from palpate.store.exporting.publication import Terms
from palpate.store.exporting.tables import Tables
from palpate.store.exporting.writing import export
from palpate.store.filters import Filter
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.own_formats import Archives
from palpate.store.opening import open_store
from palpate.store.records import ThingRef
from palpate.store.store import Store
from palpate.store.things import find_thing
from tests.store.exporting.shared import public
from tests.store.made_up import squeeze

CUP = ThingRef("lab", "cup", "Acme", "mug", {}, ("pot",))
HIDDEN = ThingRef("lab", "cup", "Hidden maker", "beaker", {"colour": "red"}, ("jar", "mug"))
OPEN = Filter(visibility="public")


@pytest.fixture
def mixed(local: Store) -> Store:
    """A cup of which a private recording, and who made it, say something else than a public one."""
    local.put(squeeze(1, thing=HIDDEN, owner="ann"))
    change_thing(local, CUP, lambda thing: thing.knowing(Value("mass", 118.0, unit="g"), "hidden scale"), who="ann")
    local.put(public(2, thing=CUP))
    return local


@pytest.mark.parametrize(("terms", "wanted"), [(Terms(), None), (Terms(include_private=True), OPEN)])
def test_tables_say_what_is_seen(mixed: Store, tmp_path: Path, terms: Terms, wanted: Filter | None) -> None:
    """Of an object, of each recording, and on the card."""
    export(mixed, HuggingFace(terms), tmp_path / "out", wanted)
    tables = {name: pl.read_parquet(tmp_path / f"out/data/{name}-*.parquet") for name in ("objects", "recordings")}
    (row,) = tables["objects"].to_dicts()
    assert [row[name] for name in ("maker", "common_name", "aliases")] == ["Acme", "mug", ["pot"]]
    assert row["attributes_json"] == "{}"
    assert tables["recordings"]["common_name"].to_list() == ["mug"]
    assert "beaker" not in (tmp_path / "out/README.md").read_text(encoding="utf-8")


def test_all_is_said_where_all_is_given(mixed: Store, tmp_path: Path) -> None:
    terms = Terms(include_private=True, authors=("ann",), licence="CC-BY-4.0")
    export(mixed, Tables(terms), tmp_path / "out")
    (row,) = pl.read_parquet(tmp_path / "out/data/objects-*.parquet").to_dicts()
    assert [row[name] for name in ("maker", "common_name")] == ["Hidden maker", "beaker"]


def test_an_archive_of_what_is_public_says_what_is_seen(mixed: Store, tmp_path: Path) -> None:
    """What is restored from it has neither hidden words nor what is known where the public does not see it."""
    export(mixed, Archive(), tmp_path / "out", OPEN)
    with open_store(tmp_path / "copy.sqlite", durable=False) as copy:
        assert {one.fate for one in import_paths(copy, [tmp_path / "out"], [Archives()])} == {Fate.NEW}
        found = find_thing(copy, "lab/cup")
    assert (found.ref, found.known) == (CUP, ())
