from importlib.util import find_spec
from pathlib import Path

import pytest

from palpate.store.errors import StoreError
from palpate.store.importing.bags import is_bag, read_bag
from palpate.store.importing.bags import opening as module
from tests.store.importing.bags.made import ns, number, topic_map, write_bag, write_mcap

MAP = '[topics."/n"]\nlog = true'


def test_bags_are_known(tmp_path: Path) -> None:
    """Folders with the metadata of a bag and files that begin or end like one are bags, nothing else is."""
    messages = [("/n", ns(0), number(1.0))]
    folder = write_bag(tmp_path / "bag", messages)
    file = write_mcap(tmp_path / "bag.mcap", messages)
    (tmp_path / "renamed").write_bytes(file.read_bytes())
    (tmp_path / "damaged.mcap").write_bytes(b"")
    (tmp_path / "store.sqlite").write_bytes((folder / "bag.db3").read_bytes())
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "metadata.yaml").write_text("name: something")
    (tmp_path / "empty").mkdir()
    bags = {path.name for path in (*tmp_path.iterdir(), tmp_path / "nowhere.mcap") if is_bag(path)}
    assert bags == {"bag", "bag.mcap", "renamed", "damaged.mcap"}


def test_what_is_no_bag_is_refused(tmp_path: Path) -> None:
    """A file of another kind, one that is not there, and a folder without metadata are one sentence each."""
    (tmp_path / "notes.txt").write_text("notes")
    (tmp_path / "empty").mkdir()
    topics = topic_map(tmp_path, MAP)
    for name, told in (
        ("notes.txt", "is no bag, expected a folder"),
        ("nowhere.mcap", "No such file"),
        ("empty", r"no metadata\.yaml in it"),
    ):
        with pytest.raises(StoreError, match=told) as refused:
            read_bag(tmp_path / name, topics)
        assert str(refused.value).startswith(str(tmp_path / name))


@pytest.mark.parametrize("name", ["mcap", "rosbags"])
def test_what_is_not_installed_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Without the libraries for bags, one sentence says what to install."""
    bag = write_bag(tmp_path / "bag", [("/n", ns(0), number(1.0))])
    monkeypatch.setattr(module, "find_spec", lambda asked: None if asked == name else find_spec(asked))
    with pytest.raises(StoreError, match=rf'bags need {name}, which is not installed: pip install "palpate\[bags\]"'):
        read_bag(bag, topic_map(tmp_path, MAP))
