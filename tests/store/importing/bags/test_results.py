import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.records import Recording
from tests.store.importing.bags.made import header, make, ns, number, text, topic_map, write_bag, write_json


def vector(*values: float) -> Any:
    layout = make("std_msgs/msg/MultiArrayLayout", dim=[], data_offset=0)
    return make("std_msgs/msg/Float32MultiArray", layout=layout, data=np.array(values, np.float32))


def read(folder: Path, messages: list[Any], result: str) -> Recording:
    bag = write_bag(folder / "bag", [("/r", ns(place), message) for place, message in enumerate(messages)])
    (found,) = read_bag(bag, topic_map(folder, f'[topics."/r"]\nresult = {{property = "mass", {result}}}'))
    return found


@pytest.mark.parametrize(
    ("take", "values"), [("take = 'first'", [1.0]), ("unit = 'g'", [3.0]), ("take = 'all'", [1.0, 2.0, 3.0])]
)
def test_numbers_are_values(tmp_path: Path, take: str, values: list[float]) -> None:
    """The last number is the result unless the map says the first or all; which it is is told."""
    found = read(tmp_path, [number(value) for value in (1.0, 2.0, 3.0)], f"{take}, sd = 0.5")
    assert [entry.value for entry in found.entries if isinstance(entry, Value)] == values
    assert any("of 3 messages" in notice for notice in found.notices) == (len(values) == 1)


def test_a_number_that_is_none_has_failed(tmp_path: Path) -> None:
    """NaN becomes a failed entry and not a number."""
    found = read(tmp_path, [number(math.nan)], "unit = 'g'")
    assert found.entries == (FailedEntry("the value is nan", "mass"),)


def test_the_sd_may_be_a_field(tmp_path: Path) -> None:
    """A field can hold the SD; one that is none is left out and told."""
    messages = [make("geometry_msgs/msg/Point", x=5.0, y=sd, z=0.0) for sd in (0.25, -1.0)]
    found = read(tmp_path, messages, "field = 'x', sd_field = 'y', unit = 'g', take = 'all'")
    assert found.entries == (Value("mass", 5.0, 0.25, "g"), Value("mass", 5.0, None, "g"))
    assert "/r: the SD is -1.0: it is left out" in found.notices


def test_labels_and_probabilities_are_distributions(tmp_path: Path) -> None:
    """A label is certain, which is told; probabilities of 32 bits are scaled until they sum to one."""
    found = read(tmp_path, [text("mug")], "field = 'data'")
    assert found.entries == (Distribution("mass", {"mug": 1.0}),)
    assert found.notices == ("/r: the result is a label: it is kept as certain",)
    (tmp_path / "two").mkdir()
    (entry,) = read(tmp_path / "two", [vector(0.1, 0.2, 0.7)], "labels = ['a', 'b', 'c']").entries
    assert isinstance(entry, Distribution)
    assert math.fsum(entry.probabilities.values()) == pytest.approx(1, abs=1e-12)
    assert entry.probabilities["b"] == pytest.approx(0.2, rel=1e-6)


@pytest.mark.parametrize(
    ("message", "result", "told"),
    [
        (number(1.0), "field = 'datum'", r"/r: there is no field 'datum' \(did you mean 'data'\?\)"),
        (vector(0.5, 0.5), "labels = ['a', 'b', 'c']", "/r data: found 2 numbers, expected one for each of 3 labels"),
        (vector(0.5, 0.5), "unit = 'g'", "found ndarray, expected a number, or labels in the map"),
    ],
)
def test_what_is_no_result_is_refused(tmp_path: Path, message: Any, result: str, told: str) -> None:
    """A field that is not there, or holds something else, is refused."""
    with pytest.raises(StoreError, match=told):
        read(tmp_path, [message], result)


def test_lines_become_the_log(tmp_path: Path) -> None:
    """What nodes log and what topics of text say is the log, in the order of its times."""
    line = make(
        "rcl_interfaces/msg/Log",
        stamp=header(ns(1.5)).stamp,
        level=30,
        name="gripper",
        msg="slipped",
        file="grip.cpp",
        function="close",
        line=3,
    )
    messages = [("/said", ns(0), text("begin")), ("/rosout", ns(2.5), line), ("/said", ns(2), text("end"))]
    bag = write_bag(tmp_path / "bag", messages)
    topics = topic_map(tmp_path, '[topics."/rosout"]\nlog = true\n[topics."/said"]\nlog = true')
    (found,) = read_bag(bag, topics)
    assert found.log == "0.000000 begin\n1.500000 WARN gripper: slipped\n2.000000 end\n"
    with pytest.raises(StoreError, match="/n: holds no line of a log"):
        read_bag(
            write_json(tmp_path / "x.mcap", [("/n", ns(0), {"data": 3})]),
            topic_map(tmp_path, '[topics."/n"]\nlog = true'),
        )
