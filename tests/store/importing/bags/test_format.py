from pathlib import Path

from palpate.store.importing.bags import Bags
from palpate.store.importing.items import Fate, Item, Outcome
from tests.store.importing.bags.made import ns, number, topic_map, write_bag

MAP = '[topics."/n".series.s]\nx = {field = "data"}\n'


def test_bags_are_a_format(tmp_path: Path) -> None:
    """A bag is owned, is one item, and is read when the item is; cut by times it is several."""
    bag = write_bag(tmp_path / "bag", [("/n", ns(i), number(i)) for i in range(9)])
    whole = Bags(topic_map(tmp_path, MAP))
    cut = Bags(topic_map(tmp_path, MAP + "[[recordings]]\nstart_s = 0\nstop_s = 4\n[[recordings]]\nstart_s = 5"))
    assert whole.owns(bag)
    assert not whole.owns(tmp_path)
    lengths = []
    for format in (whole, cut):
        items = [item for item in format.items(bag) if isinstance(item, Item)]
        assert len(items) == format.count(bag)
        assert all(item.digest in (None, item.read().digest) for item in items)
        lengths.append([len(item.read().series[0].channels[0].values) for item in items])
    assert lengths == [[9], [4, 4]]


def test_without_a_map_bags_are_skipped(tmp_path: Path) -> None:
    """Without a map of topics a bag is skipped, with a sentence on what is needed."""
    (found,) = Bags().items(write_bag(tmp_path / "bag", [("/n", ns(0), number(1.0))]))
    assert isinstance(found, Outcome)
    assert found.fate is Fate.SKIPPED
    assert found.reason is not None
    assert "--topics FILE.toml" in found.reason
