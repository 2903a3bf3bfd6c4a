import re
from collections import Counter
from pathlib import Path

import pytest
import yaml

from palpate.store.entries import Value
from palpate.store.exporting.card import _size
from palpate.store.exporting.hugging_face import HuggingFace
from palpate.store.exporting.publication import Terms
from palpate.store.records import ThingRef
from palpate.store.store import Store
from tests.store.exporting.shared import public, written

MADE = [
    public(number, action=("squeezing", "weighing")[number % 4 == 0], ground_truth=number == 1, notices=("odd | #1",))
    for number in range(9)
]


@pytest.fixture
def card(local: Store, tmp_path: Path) -> str:
    local.put_many(MADE)
    written(local, HuggingFace(), tmp_path / "given")
    return (tmp_path / "given" / "README.md").read_text(encoding="utf-8")


def test_the_front_matter_names_files_that_are_there(card: str, tmp_path: Path) -> None:
    """The Hub finds licence, size and, for each table, files that exist; the first table is shown first."""
    plain = yaml.safe_load(card.split("---\n")[1])
    assert plain["license"] == "cc-by-4.0"
    assert plain["task_categories"] == ["robotics"]
    assert plain["size_categories"] == ["n<1K"]
    assert [each["config_name"] for each in plain["configs"]] == [
        "recordings",
        "entries",
        "channels",
        "objects",
        "setups",
    ]
    assert plain["configs"][0]["default"] is True
    for each in plain["configs"]:
        assert list((tmp_path / "given").glob(each["data_files"][0]["path"]))
    assert len(list((tmp_path / "given" / "data").iterdir())) == len(plain["configs"])


def test_counts_by_object_and_action(card: str) -> None:
    """The table of objects and actions counts what is in the store."""
    counts = Counter((each.thing.id, each.action) for each in MADE)
    for name in ("object0", "object1", "object2"):
        row = f"| {name} | made\\_up | {name} | {counts[name, 'squeezing']} | {counts[name, 'weighing'] or ''} |"
        assert row in card
    assert "Known to be true: the results of 1 of 9 recordings." in card
    assert "| odd \\| \\#1 | 9 |" in card
    assert "| elasticity | value | kPa | 9 |" in card
    assert "gripper two\\_finger by somebody | 9 |" in card


def test_paper_and_columns_are_there(card: str) -> None:
    """The card cites the paper and explains each column with its unit."""
    assert "doi       = {10.1109/IROS58592.2024.10802249}" in card
    assert "| time\\_s | list of numbers | time stamps \\[s\\], where they are not |" in card


def test_another_licence_has_a_name(local: Store, tmp_path: Path) -> None:
    """A licence that the Hub does not know is ``other`` with its name."""
    local.put(public(1))
    written(local, HuggingFace(Terms(licence="ours: alone", title="A title: ours")), tmp_path / "given")
    plain = yaml.safe_load((tmp_path / "given" / "README.md").read_text(encoding="utf-8").split("---\n")[1])
    assert (plain["license"], plain["license_name"]) == ("other", "ours: alone")
    assert plain["pretty_name"] == "A title: ours"


def test_odd_names_do_not_break_the_card(local: Store, tmp_path: Path) -> None:
    """Whatever objects and units are called, each row of a table has as many cells as its head."""
    thing = ThingRef("a|b", "x\ny", common_name="---\n| <script>")
    local.put_checked([public(1, thing=thing, entries=(Value("p | q", 1.0),))])
    written(local, HuggingFace(), tmp_path / "given")
    text = (tmp_path / "given" / "README.md").read_text(encoding="utf-8")
    for part in re.findall(r"(?:^\|.*\n)+", text, flags=re.MULTILINE):
        assert len({len(re.findall(r"(?<!\\)\|", line)) for line in part.splitlines()}) == 1
    assert "<script>" not in text.replace("\\<script\\>", "")


@pytest.mark.parametrize(
    ("count", "name"), [(1, "n<1K"), (1000, "1K<n<10K"), (99_999, "10K<n<100K"), (10**6, "1M<n<10M"), (10**8, "n>10M")]
)
def test_sizes_have_the_names_of_the_hub(count: int, name: str) -> None:
    """A size is the range that it is in."""
    assert _size(count) == name
