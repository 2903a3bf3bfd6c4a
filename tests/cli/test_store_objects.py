import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.cli.known_values import entry_of
from palpate.errors import PalpateError
from palpate.store.entries import Bound, Distribution, Entry, Interval, Value
from palpate.store.opening import open_store
from palpate.store.pictures import png
from palpate.store.records import ThingRef
from tests.store.made_up import squeeze

PICTURE = png(np.zeros((2, 3, 3), np.uint8), "picture")


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store with a mug and a cup, which the commands find by the environment."""
    path = tmp_path / "store.sqlite"
    monkeypatch.setenv("PALPATE_STORE", str(path))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    with open_store(path) as store:
        store.put_many(squeeze(number, thing=ThingRef("ycb", name)) for number, name in enumerate(("mug", "cup")))
    return path


def test_an_object_is_described_and_shown(run: Any, place: Path, tmp_path: Path) -> None:
    """What was set, what is known and from where, what was measured and who changed what are shown together."""
    (tmp_path / "front.png").write_bytes(PICTURE)
    words = ("--common-name", "coffee mug", "--maker", "somebody", "--alias", "beaker", "--attribute", "age=3")
    assert run("store", "object", "set", "mug", *words, "--image", tmp_path / "front.png", "--who", "ann").code == 0
    told = run("store", "object", "know", "beaker", "mass", "118 g", "--sd", 2, "--source", "our scale").out
    assert told == "ycb/mug: mass 118 ± 2.00 g (our scale)\n"
    run("store", "object", "know", "mug", "material", "ceramic", "--source", "data sheet")
    shown = " ".join(run("store", "object", "show", "coffee mug").out.split())
    for text in (
        "called: coffee mug",
        "age: 3",
        "images: front.png",
        "mass 118 ± 2.00 g our scale",
        "elasticity gripper two_finger 1 40.0 kPa",
        "maker: nothing -> somebody",
        "ann",
    ):
        assert text in shown
    plain = json.loads(run("store", "object", "show", "mug", "--json", "--images", tmp_path / "saved").out)
    assert plain["attributes"] == {"age": 3}
    assert [one["source"] for one in plain["known"]] == ["our scale", "data sheet"]
    assert [one["what"] for one in plain["history"]] == ["changed"] * 3
    assert (tmp_path / "saved" / "front.png").read_bytes() == PICTURE
    listed = json.loads(run("store", "objects", "--json").out)
    assert [(one["id"], len(one["known"])) for one in listed] == [("cup", 0), ("mug", 2)]
    assert "coffee mug" in run("store", "objects").out


def test_a_setup_that_measured_much_is_told_once(run: Any, place: Path) -> None:
    """Devices stand in the first row of those that they measured."""
    with open_store(place) as store:
        store.put(squeeze(7, thing=ThingRef("ycb", "mug"), entries=(Value("mass", 1.0, unit="g"),)))
    shown = " ".join(run("store", "object", "show", "mug").out.split())
    assert "elasticity gripper two_finger 1 40.0 kPa mass the same 1 1.00 g" in shown


def test_changes_are_taken_back(run: Any, place: Path) -> None:
    """Undoing takes back what is known, a merge, and in the end has nothing left."""
    run("store", "object", "know", "mug", "mass", "118 g", "--source", "scale")
    assert run("store", "object", "merge", "mug", "cup").out == "ycb/mug counts as ycb/cup\n"
    assert json.loads(run("store", "object", "show", "cup", "--json").out)["merged"] == [["ycb", "mug"]]
    told = run("store", "object", "undo", "ycb/mug").out
    assert re.fullmatch(r"ycb/mug: taken back what was merged by .+ at .{19} UTC\n- into ycb/cup\n", told)
    run("store", "object", "merge", "mug", "cup")
    assert run("store", "object", "split", "mug", "--who", "bob").out == "ycb/mug is an object of its own\n"
    told = run("store", "object", "undo", "mug").out
    assert told.splitlines()[1:] == ["- known.mass.scale: nothing -> mass 118 g"]
    assert "has no change to take back" in run("store", "object", "undo", "mug").refused
    assert "taken back by bob" in " ".join(run("store", "object", "show", "mug").out.split())


def test_parts_are_removed_and_forgotten(run: Any, place: Path) -> None:
    """Aliases, attributes and known properties go again; what is not there is named."""
    run("store", "object", "set", "mug", "--alias", "beaker", "--attribute", "colour=red", "--maker", "x")
    told = run("store", "object", "set", "mug", "--remove", "alias:beaker", "--remove", "attribute:colour").out
    assert told == "ycb/mug: changed\n"
    run("store", "object", "set", "mug", "--remove", "maker")
    plain = json.loads(run("store", "object", "show", "mug", "--json").out)
    assert (plain["aliases"], plain["attributes"], plain["maker"]) == ([], {}, None)
    assert "ycb/mug has no alias 'beaker'" in run("store", "object", "set", "mug", "--remove", "alias:beaker").refused
    assert "--remove: 'size' was found" in run("store", "object", "set", "mug", "--remove", "size").refused
    run("store", "object", "know", "mug", "mass", "118 g", "--source", "scale")
    assert run("store", "object", "forget", "mug", "mass").out == "ycb/mug: 1 item forgotten\n"
    assert "nothing is known of 'mass'" in run("store", "object", "forget", "mug", "mass").refused
    assert run("store", "object", "set", "mug").out == "ycb/mug: nothing to change\n"


def test_objects_can_be_added_before_they_are_measured(run: Any, place: Path) -> None:
    """An object is added once, and found from then on."""
    assert run("store", "object", "add", "our lab/sponge").out == "our lab/sponge: added\n"
    assert run("store", "object", "add", "our lab/sponge").out == "our lab/sponge: is there already\n"
    assert json.loads(run("store", "object", "show", "sponge", "--json").out)["recordings"] == 0
    assert "expected DATASET/NAME" in run("store", "object", "add", "sponge").refused


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("show", "mgu"), "object 'mgu': is not in the store (did you mean 'mug'?)"),
        (("set", "mug", "--attribute", "red"), "--attribute: 'red' was found, expected NAME=VALUE"),
        (("set", "mug", "--image", "nowhere.png"), "--image: there is no file 'nowhere.png'"),
        (("set", "mug", "--image", "/etc/passwd"), "--image: '/etc/passwd' is no picture, expected PNG, JPEG"),
        (("know", "mug", "mass", "heavy", "--source", "x"), "VALUE: 'heavy' is no number, expected a number with its"),
        (("know", "mug", "mass", "1,5 g", "--source", "x"), "VALUE: '1,5 g' was found, expected a point in a number"),
        (("know", "mug", "elasticity", "soft", "--source", "x"), "'soft' is a label, and elasticity is a number here"),
        (("know", "mug", "elasticity", "soft=1", "--source", "x"), "is a label, and elasticity is a number here"),
        (("know", "mug", "elasticity", "40", "--source", "x"), "VALUE: '40' has no unit, expected one such as 'kPa'"),
        (("know", "mug", "elasticity", "40 g", "--source", "x"), "known elasticity.unit: unit 'g' is mass; expected"),
        (
            ("know", "mug", "material", "ceramc", "--source", "x"),
            "is no label of material here (did you mean 'ceramic'",
        ),
        (("know", "mug", "mass", "heavy ± 2 g", "--source", "x"), "VALUE: 'heavy ± 2 g' was found"),
        (("know", "mug", "mass", "9 ± 2 g", "--sd", "1", "--source", "x"), "--sd: '9 ± 2 g' has an SD already"),
        (("know", "mug", "mass", "9 ± -2 g", "--source", "x"), "known mass.sd: found -2.0, expected zero or more"),
        (("know", "mug", "mass", "118 nonsense", "--source", "x"), "unknown unit 'nonsense'"),
        (("know", "mug", "mass", "heavy=much", "--source", "x"), "VALUE: 'heavy=much' was found"),
        (("know", "mug", "material", "wood", "--sd", "1", "--source", "x"), "--sd: 'wood' is no single number"),
        (("know", "mug", "kind", "a=0.5", "--source", "x"), "probabilities: sum to 0.5, expected 1"),
        (("merge", "mug", "mug"), "is the same object"),
        (("split", "mug"), "is not merged"),
    ],
)
def test_what_makes_no_sense_is_refused(run: Any, place: Path, arguments: tuple[str, ...], message: str) -> None:
    """One sentence, and nothing is changed."""
    assert message in run("store", "object", *arguments).refused
    assert json.loads(run("store", "object", "show", "mug", "--json").out)["history"] == []


def test_what_is_known_is_told_as_it_is_kept(run: Any, place: Path) -> None:
    """A number below zero is no option, an SD is kept, and what is no longer known is told."""
    know = ("store", "object", "know", "mug")
    assert run(*know, "offset", "-5 g", "--source", "scale").out == "ycb/mug: offset -5.00 g (scale)\n"
    run(*know, "mass", "118 ± 2 g", "--source", "scale")
    told = run(*know, "mass", "119 g", "--source", "scale").out
    assert told == "ycb/mug: mass 119 g (scale)\n- in place of mass 118 ± 2.00 g\n"


def test_a_new_label_is_told_as_one(run: Any, place: Path) -> None:
    """A label that is near to another, or of what is a number elsewhere, is taken where it is told with a probability.

    Where a property has labels in the store, a number is refused.
    """
    know = ("store", "object", "know", "mug")
    for name, value in (("material", "ceramc=1"), ("material", "ivory"), ("mass", "heavy=1"), ("mass", "light")):
        assert run(*know, name, value, "--source", value).code == 0
    assert (
        "'5 g' is a number, and mass has labels here; choose from 'heavy'"
        in run(*know, "mass", "5 g", "--source", "x").refused
    )


def test_an_option_that_is_misspelt_is_refused(run: Any, place: Path) -> None:
    """Taking numbers below zero for values does not take options for values."""
    assert "--sorce" in run("store", "object", "know", "mug", "mass", "5 g", "--source", "x", "--sorce", "x").refused


@pytest.mark.parametrize(
    ("text", "entry"),
    [
        ("118", Value("p", 118.0)),
        ("-1.5e3 kg/m^3", Value("p", -1500.0, unit="kg/m^3")),
        ("90 to 100 kPa", Interval("p", 90.0, 100.0, "kPa")),
        ("118 ± 2 g", Value("p", 118.0, 2.0, "g")),
        ("118+/-2.5e-1 g", Value("p", 118.0, 0.25, "g")),
        ("-5 +- 1", Value("p", -5.0, 1.0)),
        ("below 5 kPa", Bound("p", below=5.0, unit="kPa")),
        ("hard plastic", Distribution("p", {"hard plastic": 1.0})),
        ("a=0.25, b=0.75", Distribution("p", {"a": 0.25, "b": 0.75})),
    ],
)
def test_values_are_read_as_they_are_written(text: str, entry: Entry) -> None:
    """Numbers, intervals, bounds, labels and distributions can be told in words."""
    assert entry_of("p", text) == entry


@pytest.mark.parametrize("text", [" ", "nan g", "-inf"])
def test_no_value_is_refused(text: str) -> None:
    """An empty value, and a number that is none, is an error that shows what could be said."""
    with pytest.raises(PalpateError, match="choose from '118 g'"):
        entry_of("p", text)
