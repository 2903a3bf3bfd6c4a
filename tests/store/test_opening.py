from pathlib import Path

import pytest

from palpate.store.blobs import FolderBlobs
from palpate.store.errors import StoreError
from palpate.store.opening import open_store
from tests.store.made_up import squeeze


def test_a_store_is_made_on_first_use_and_stays(tmp_path: Path) -> None:
    """A store in a folder that is not there is made, with its blobs beside; what was put is there next time."""
    path = tmp_path / "lab" / "store.sqlite"
    with open_store(path) as store:
        receipt = store.put(squeeze())
        assert isinstance(store.blobs, FolderBlobs)
        assert store.blobs.folder == tmp_path / "lab" / "store.sqlite-blobs"
    with open_store(f"sqlite:///{path}") as store:
        assert store.get(receipt.id).digest == receipt.digest


def test_the_environment_says_where(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """PALPATE_STORE and PALPATE_BLOBS are heeded unless a place is given; without them it is the user's data folder."""
    monkeypatch.setenv("PALPATE_STORE", str(tmp_path / "one.sqlite"))
    monkeypatch.setenv("PALPATE_BLOBS", str(tmp_path / "blobs"))
    with open_store() as store:
        assert isinstance(store.blobs, FolderBlobs)
        assert store.blobs.folder == tmp_path / "blobs"
    assert (tmp_path / "one.sqlite").exists()
    monkeypatch.delenv("PALPATE_STORE")
    monkeypatch.delenv("PALPATE_BLOBS")
    monkeypatch.setattr("palpate.store.opening.default_path", lambda: tmp_path / "data" / "store.sqlite")
    with open_store():
        assert (tmp_path / "data" / "store.sqlite").exists()


def test_places_that_cannot_be_used_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A folder under a file, a file that is no database and PostgreSQL without blobs are errors in one sentence."""
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    plain = tmp_path / "plain.txt"
    plain.write_text("mug" * 1000)
    with pytest.raises(StoreError, match="cannot be made"):
        open_store(plain / "store.sqlite")
    with pytest.raises(StoreError, match="PALPATE_BLOBS: is not set"):
        open_store("postgresql+psycopg://lab@127.0.0.1:1/nowhere")
    with pytest.raises(StoreError, match="not a database"):
        open_store(plain)
