"""The household network: published figures, and the 17 objects."""

import numpy as np
import pytest

from palpate.network.families import Normal
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty
from palpate.network.reading import load_network
from palpate.network.sensors import ConfusionSensor, NumberSensor

OBJECTS = [
    "banana",
    "banana_ycb",
    "black_kinova_cube_heavy",
    "ceramic_mug",
    "cracker_box_ycb",
    "enamel_mug_ycb",
    "plastic_cup_ycb",
    "soft_brick_ycb",
    "soft_yellow_sponge",
    "stiff_yellow_sponge",
    "strawberry_fake",
    "strawberry_ycb",
    "white_kinova_cube_light",
    "white_tile",
    "wineglass",
    "wineglass_ycb",
    "wooden_box_ycb",
]


@pytest.fixture(scope="module")
def household() -> Network:
    return load_network("household")


def table(network: Network, action: str) -> tuple[np.ndarray, tuple[str, ...], tuple[str, ...]]:
    sensor = network.actions[action].sensor
    assert isinstance(sensor, ConfusionSensor)
    prop = network.properties[sensor.property]
    assert isinstance(prop, CategoricalProperty)
    return sensor.table, sensor.outcomes, prop.states


@pytest.mark.parametrize(
    ("name", "parent", "state", "mean", "sd"),
    [
        ("elasticity", "material", "ceramic", 150, 10),
        ("elasticity", "material", "paper", 35, 28),
        ("density", "material", "metal", 7900, 600),
        ("density", "material", "foam", 91.95, 127.65),
        ("volume", "category", "fruit", 155.75, 28),
        ("volume", "category", "plate", 0, 15),
    ],
)
def test_published_means_and_sds(
    household: Network, name: str, parent: str, state: str, mean: float, sd: float
) -> None:
    """Means and SDs are the published ones before truncation, and negative values are cut off."""
    prop, above = household.properties[name], household.properties[parent]
    assert isinstance(prop, ContinuousProperty)
    assert isinstance(above, CategoricalProperty)
    assert isinstance(prop.family, Normal)
    index = above.states.index(state)
    assert (prop.family.mean[index], prop.family.sd[index], prop.family.low[index]) == (mean, sd, 0)
    assert prop.family.high[index] == np.inf


@pytest.mark.parametrize(
    ("action", "outcome", "truth", "value"),
    [
        ("cat-vision", "box", "bottle", 0.13545816733067736),
        ("cat-vision", "bottle", "box", 0.0272762765195634),
        ("cat-vision", "mug", "wineglass", 0.1),
        ("mat-vision", "metal", "foam", 0.35443598317849817),
        ("mat-vision", "hard-plastic", "hard-plastic", 0.000999000999000999),
        ("mat-sound", "ceramic", "glass", 0.5970149253731346),
        ("mat-sound", "glass", "foam", 0.5306799303482588),
    ],
)
def test_published_confusions(household: Network, action: str, outcome: str, truth: str, value: float) -> None:
    """P(outcome | truth) is the published number, and not the one with the two exchanged."""
    matrix, outcomes, states = table(household, action)
    assert matrix[outcomes.index(outcome), states.index(truth)] == pytest.approx(value, rel=1e-12)


def test_published_materials_of_categories(household: Network) -> None:
    """P(material | category) is the published number."""
    material = household.properties["material"]
    assert isinstance(material, CategoricalProperty)
    category = household.properties["category"]
    assert isinstance(category, CategoricalProperty)
    row = material.table[category.states.index("mug")]
    assert row[material.states.index("ceramic")] == pytest.approx(0.37453183520599254, rel=1e-12)
    assert row[material.states.index("glass")] == pytest.approx(0.12484394506866418, rel=1e-12)


def test_number_sensors_and_costs(household: Network) -> None:
    """Squeezing saturates above 95 kPa, weighing has 6 g; costs are as assumed; cameras see the appearance."""
    squeezing, weighing = household.actions["squeezing"].sensor, household.actions["weighing"].sensor
    assert isinstance(squeezing, NumberSensor)
    assert isinstance(weighing, NumberSensor)
    assert (squeezing.sd, squeezing.low, squeezing.high) == (10, -np.inf, 95)
    assert (weighing.property, weighing.sd, weighing.high) == ("mass", 6, np.inf)
    costs = {name: action.cost_s for name, action in household.actions.items()}
    assert costs == {"cat-vision": 1, "mat-vision": 1, "mat-sound": 8, "squeezing": 20, "weighing": 15}
    assert [a.name for a in household.actions.values() if a.sees_appearance] == ["cat-vision", "mat-vision"]


def test_mass_is_density_times_volume(household: Network) -> None:
    """800 kg/m^3 x 50 cm^3 = 40 g, without rounding."""
    mass = household.derived[0]
    assert mass.unit == "g"
    assert float(mass.formula.evaluate({"density": 800.0, "volume": 50.0})) == 40.0


def test_filled_columns_differ_and_nothing_else(household: Network) -> None:
    """household-filled has 0.86 and an even rest in the three empty cat-vision columns only."""
    filled, outcomes, states = table(load_network("household-filled"), "cat-vision")
    published = table(household, "cat-vision")[0]
    empty = [states.index(name) for name in ("dice", "sodacan", "wineglass")]
    others = [i for i in range(10) if i not in empty]
    np.testing.assert_array_equal(filled[:, others], published[:, others])
    np.testing.assert_allclose(published[:, empty], 0.1)
    expected = np.full((10, 3), 0.14 / 9)
    expected[empty, range(3)] = 0.86
    np.testing.assert_allclose(filled[:, empty], expected)
    assert outcomes == states


def test_the_17_objects_ship(household: Network) -> None:
    """The objects of the paper are there by name, in both variants, with every property."""
    for network in (household, load_network("household-filled")):
        assert [*network.objects] == OBJECTS
        assert all([*thing.truth] == [*network.properties] for thing in network.objects.values())


@pytest.mark.parametrize("name", OBJECTS)
def test_mass_is_consistent(household: Network, name: str) -> None:
    """Mass = density x volume to the rounding of the volume."""
    truth = household.objects[name].truth
    density, volume, mass = (float(truth[key].value) for key in ("density", "volume", "mass"))
    assert density * volume / 1000 == pytest.approx(mass, rel=6e-4)


@pytest.mark.parametrize("name", OBJECTS)
def test_every_figure_is_marked(household: Network, name: str) -> None:
    """Every true value says whether it is measured or assumed, and from where."""
    assert all(value.source for value in household.objects[name].truth.values())


def test_published_masses(household: Network) -> None:
    """Masses of the YCB set are measured."""
    masses = {
        "banana_ycb": 66,
        "cracker_box_ycb": 411,
        "enamel_mug_ycb": 118,
        "soft_brick_ycb": 28,
        "strawberry_ycb": 18,
    }
    for name, mass_g in masses.items():
        found = household.objects[name].truth["mass"]
        assert (found.value, found.status) == (mass_g, "measured")


def test_three_tricks_and_the_real_banana(household: Network) -> None:
    """One of each pair that looks alike is a trick; the real banana's material is a stand-in."""
    tricks = {name: thing.looks_like for name, thing in household.objects.items() if thing.is_trick}
    assert tricks == {
        "banana_ycb": "banana",
        "stiff_yellow_sponge": "soft_yellow_sponge",
        "wineglass_ycb": "wineglass",
    }
    assert not household.objects["banana"].truth["material"].scored
