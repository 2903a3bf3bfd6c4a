"""What is known beside what is believed."""

from dataclasses import replace

from palpate.inference.exact import ExactBelief
from palpate.network.reading import load_network
from palpate.server.verdicts import verdicts
from palpate.store.entries import Bound, Distribution, Value
from palpate.store.things import Known
from palpate.summary import CategoricalSummary, summarise


def test_what_is_known_is_beside_what_is_believed() -> None:
    """In another unit too; of what the network does not have, or is no number of it, nothing is said."""
    belief = summarise(ExactBelief(load_network("household-filled")))
    known = [
        Known(Value("mass", 0.1, unit="kg"), "a scale"),
        Known(Value("density", 1e9, unit="kg/m^3"), "nonsense"),
        Known(Value("elasticity", 1.0, unit="kg"), "another unit"),
        Known(Bound("volume", above=1.0, unit="cm^3"), "a bound"),
        Known(Distribution("material", {"cheese": 1.0}), "no material here"),
        Known(Distribution("category", {"mug": 1.0}), "a person"),
        Known(Distribution("colour", {"red": 1.0}), "a person"),
    ]
    found = verdicts(known, belief)
    assert set(found) == {"mass", "density", "category"}
    assert (found["mass"].known, found["mass"].mark, found["mass"].words) == (
        "100 g",
        "✓",
        "found: inside the 90 % interval",
    )
    material = belief["material"]
    assert isinstance(material, CategoricalSummary)
    other = replace(material, probabilities={**material.probabilities, "glass": 0.55, "ceramic": 0.42})
    (told,) = verdicts([Known(Distribution("material", {"ceramic": 1.0}), "a person")], {"material": other}).values()
    assert told.words == "not found: glass is more probable (55%) than ceramic (42%)"
    assert (found["density"].is_found, found["density"].mark) == (False, "✗")
