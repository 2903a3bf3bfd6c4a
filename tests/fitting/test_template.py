"""Templates: networks of which numbers may be left out."""

from pathlib import Path

import numpy as np
import pytest

from palpate.errors import NetworkError
from palpate.fitting.template import read_template
from palpate.network.digest import digest
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network, shipped_networks
from palpate.network.sensors import ConfusionSensor
from tests.fitting.made_up import WORKSHOP, workshop

BLANK = """
format = "palpate-network/1"
[properties.kind]
states = ["bolt", "nut"]
[properties.metal]
states = ["steel", "brass", "zinc"]
parents = ["kind"]
[properties.density]
unit = "g/cm^3"
family = "truncated-normal"
low = 0
parents = ["metal"]
[properties.volume]
unit = "cm^3"
family = "lognormal"
parents = ["kind"]
[properties.hardness]
unit = "GPa"
family = "gamma"
[properties.mass]
unit = "g"
formula = "density * volume"
[actions.look]
cost_s = 1
[actions.look.sensor]
property = "kind"
kind = "confusion"
outcomes = ["bolt", "nut", "else"]
[actions.weigh]
cost_s = 2
[actions.weigh.sensor]
property = "mass"
kind = "normal"
saturates_above = 35
[actions.scratch]
cost_s = 2
[actions.scratch.sensor]
property = "hardness"
kind = "student-t"
dof = 5
"""


@pytest.mark.parametrize("name", shipped_networks())
def test_a_whole_network_is_a_template(name: str) -> None:
    """Of a network with all numbers nothing is blank, and it is that network."""
    template = read_template(name)
    assert digest(template.network) == digest(load_network(name)) == template.digest
    assert not template.blank_properties | template.blank_actions
    assert "extends" not in template.tables


def test_numbers_may_be_left_out(tmp_path: Path) -> None:
    """What has no numbers is named; structure, units, limits and outcomes are those of the file."""
    template, whole = read_template(workshop(tmp_path, BLANK)), load_network(workshop(tmp_path))
    assert template.blank_properties == {"metal", "density", "volume", "hardness"}
    assert template.blank_actions == {"look", "weigh", "scratch"}
    assert list(template.network.properties) == list(whole.properties)
    metal = template.network.property("metal")
    assert isinstance(metal, CategoricalProperty)
    np.testing.assert_allclose(metal.table, 1 / 3)
    look = template.network.actions["look"].sensor
    assert isinstance(look, ConfusionSensor)
    assert look.table.shape == (3, 2)
    assert template.network.actions["weigh"].sensor.high == 35  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('parents = ["kind"]\n[properties.metal.given]', 'parents = ["sort"]\n[properties.metal.x]', "unknown"),
        ('states = ["bolt", "nut"]', "states = []", "found no states"),
        ('states = ["bolt", "nut"]', "states = 3", "found 3; expected a list of names"),
        ("steel = {mean = 7.8, sd = 0.3}", "steel = {mean = 7.8}", "found no 'sd'"),
        ("shape = 9\n", "", "found no 'shape'"),
        ("dof = 5", "", "found no 'dof'"),
        ("[properties.kind]", "[propertys.kind]", "unknown key 'propertys'"),
        ("[actions.look.sensor]", "[actions.look.senser]", "unknown key 'senser'"),
    ],
)
def test_what_is_wrong_is_still_refused(tmp_path: Path, old: str, new: str, message: str) -> None:
    """Leaving numbers out is no licence for mistakes: half of the numbers, and wrong names, are errors."""
    assert old in WORKSHOP
    with pytest.raises(NetworkError) as caught:
        read_template(workshop(tmp_path, WORKSHOP.replace(old, new)))
    assert message in str(caught.value)
