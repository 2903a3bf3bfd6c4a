import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.cli import options
from palpate.errors import PalpateError
from palpate.network.reading import load_network
from palpate.selection.objectives import Everything, Learn
from palpate.selection.policies import FixedOrder, Greedy, GreedyPerCost, Random
from palpate.selection.stopping import (
    AnyOf,
    CostBudget,
    EntropyBelow,
    GainBelow,
    NetGainBelow,
    NothingLeft,
    SdBelow,
    StepBudget,
)

NETWORK = load_network("household")


@pytest.mark.parametrize(
    ("names", "objective"),
    [
        ([], Everything()),
        (["everything"], Everything()),
        (["material"], Learn("material")),
        (["material", "mass"], Learn("material", "mass")),
        (["material,mass", "material"], Learn("material", "mass")),
        (["material", "everything"], Everything()),
    ],
)
def test_objectives(names: list[str], objective: object) -> None:
    """Several properties are learned together, commas and repeats are the same, everything holds all."""
    assert options.objective(NETWORK, names) == objective


@pytest.mark.parametrize(
    ("text", "policy"),
    [
        ("greedy", Greedy()),
        ("greedy-per-cost", GreedyPerCost()),
        ("random", Random()),
        ("fixed:weighing,squeezing", FixedOrder(["weighing", "squeezing"])),
    ],
)
def test_policies(text: str, policy: object) -> None:
    """Each name is one policy object."""
    assert options.policy(NETWORK, text) == policy


@pytest.mark.parametrize(("text", "kind"), [("static:2", "StaticSet"), ("look-ahead:3", "LookAhead")])
def test_policies_with_a_number(text: str, kind: str) -> None:
    """The best static set and the look-ahead take a whole number."""
    assert type(options.policy(NETWORK, text)).__name__ == kind


@pytest.mark.parametrize(
    ("text", "rule"),
    [
        ("gain:0.1", GainBelow(0.1)),
        ("net-gain:0.01", NetGainBelow(0.01)),
        ("entropy:material:0.5", EntropyBelow("material", 0.5)),
        ("sd:mass:5", SdBelow("mass", 5)),
        ("cost:60", CostBudget(60)),
        ("steps:3", StepBudget(3)),
        ("nothing-left", NothingLeft()),
    ],
)
def test_stopping_rules(text: str, rule: object) -> None:
    """Each word is one stopping rule."""
    assert options.stopping(NETWORK, [text]) == rule


def test_stopping_rules_compose() -> None:
    """Several rules, however given, stop as soon as one does; a budget alone keeps the default rule."""
    both = AnyOf((GainBelow(0.1), StepBudget(3)))
    assert options.stopping(NETWORK, ["gain:0.1,steps:3"]) == both
    assert options.stopping(NETWORK, ["gain:0.1", "steps:3"]) == both
    assert options.stopping(NETWORK, ["gain:0.1"], steps=3) == both
    assert options.stopping(NETWORK, [], budget_s=30) == AnyOf((GainBelow(0.05), CostBudget(30)))
    assert options.stopping(NETWORK, []) == GainBelow(0.05)


@given(st.floats(0, 1e9), st.integers(1, 10**6))
def test_words_of_rules_are_the_rules(budget_s: float, steps: int) -> None:
    """What the log says of the stopping rules can be typed, and means the same."""
    words = options.stopping_words(["sd:mass:5"], budget_s, steps)
    assert options.stopping(NETWORK, [words]) == options.stopping(NETWORK, ["sd:mass:5"], budget_s, steps)


def test_costs() -> None:
    """A cost given takes the place of the network's; all others stay."""
    found = options.costs(NETWORK, ["weighing=2.5,squeezing=0"])
    own = {name: action.cost_s for name, action in NETWORK.actions.items()}
    assert found == {**own, "weighing": 2.5, "squeezing": 0.0}


@pytest.mark.parametrize(
    ("texts", "said"),
    [
        (["weighing"], "ACTION=SECONDS"),
        (["wieghing=1"], "'weighing'"),
        (["weighing=-1"], "at least 0"),
        (["weighing=nan"], "finite"),
        (["weighing=inf"], "finite"),
        (["weighing=long"], "finite"),
        (["weighing=1", "weighing=2"], "two costs, 1 and 2, were found, expected one"),
        (["weighing=1,weighing=1"], "expected one"),
        ([""], "'' holds nothing"),
    ],
)
def test_wrong_costs(texts: list[str], said: str) -> None:
    """A cost that is none is refused with the option and what would be right."""
    with pytest.raises(PalpateError, match=r"^--cost") as refused:
        options.costs(NETWORK, texts)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    "text", ["gredy", "greedy:1", "static", "static:0", "static:two", "look-ahead:-1", "fixed:", "fixed:kick"]
)
def test_wrong_policies(text: str) -> None:
    """A policy that does not exist, or whose argument is wrong, is refused."""
    with pytest.raises(PalpateError, match=r"^--policy"):
        options.policy(NETWORK, text)


@pytest.mark.parametrize(
    "text",
    ["gain", "gain:x", "gain:-1", "gain:nan", "entropy:0.5", "entropy:colour:1", "sd:mass", "steps:0", "steps:1.5"],
)
def test_wrong_stopping_rules(text: str) -> None:
    """A stopping rule that does not exist, or whose argument is wrong, is refused."""
    with pytest.raises(PalpateError, match=r"^--stop"):
        options.stopping(NETWORK, [text])


def test_unknown_property_to_learn() -> None:
    """A property that the network does not have is refused with those it has, and everything."""
    with pytest.raises(
        PalpateError, match=r"--learn: unknown property 'colour'; choose from 'category', .*'everything'"
    ):
        options.objective(NETWORK, ["colour"])


@pytest.mark.parametrize("text", ["", " ", ",", " , ,"])
def test_lists_that_hold_nothing(text: str) -> None:
    """An option given with nothing in it is refused and does not count as left out."""
    with pytest.raises(PalpateError, match=r"^--learn: '.*' holds nothing, expected at least one item"):
        options.objective(NETWORK, ["material", text])
    with pytest.raises(PalpateError, match=r"^--stop: "):
        options.stopping(NETWORK, [text])


def test_words_that_are_nearly_right() -> None:
    """The word that was probably meant is named, whatever stands behind its colon."""
    with pytest.raises(PalpateError, match=r"did you mean 'look-ahead'\?"):
        options.policy(NETWORK, "lookahead:3")
    with pytest.raises(PalpateError, match=r"did you mean 'entropy'\?"):
        options.stopping(NETWORK, ["entrpy:material:1"])
    with pytest.raises(PalpateError, match=r"'mas' \(did you mean 'mass'\?\) is no continuous property"):
        options.stopping(NETWORK, ["sd:mas:1"])
