"""Reading networks: the example of the docstring, extending, CSV, tables by name, defaults."""

import inspect
import time
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

from palpate.network import reading
from palpate.network.noises import StudentTNoise
from palpate.network.properties import CategoricalProperty, ContinuousProperty, DerivedProperty
from palpate.network.reading import load_network, shipped_networks
from palpate.network.sensors import ConfusionSensor, NumberSensor


def written(folder: Path, text: str, name: str = "net.toml") -> Path:
    path = folder / name
    path.write_text('format = "palpate-network/1"\n' + text, encoding="utf-8")
    return path


def example() -> str:
    """The TOML of the module's docstring, without what only shows that it is possible."""
    document = inspect.getdoc(reading)
    assert document is not None
    lines = [line[4:] for line in document.splitlines() if line.startswith("    ")]
    left_out = ("format =", "extends =", "looks_like", "tables merge")
    return "\n".join(line for line in lines if not any(part in line for part in left_out))


def test_the_format_of_the_docstring_is_valid(tmp_path: Path) -> None:
    """The example that documents the format is a network, and means what its comments say."""
    network = load_network(written(tmp_path, example()))
    assert network.name == "kitchen"
    category, material = network.categorical
    np.testing.assert_allclose(category.table, [0.7, 0.3])
    np.testing.assert_allclose(material.table, [[1, 0], [0, 1]])
    assert network.actions["look"].sees_appearance
    assert not network.actions["weigh"].sees_appearance
    assert network.objects["tin_mug"].truth["material"].status == "assumed"


PROPERTY = """
[properties.size]
states = ["small", "large"]
[properties.kind]
states = ["x", "y", "z"]
"""


def test_two_parents_nest_in_their_order(tmp_path: Path) -> None:
    """given.small.x is the row of the first parent's state, then the second's."""
    rows = "\n".join(
        f"{size}.{kind} = [{0.1 * i + 0.01 * j}, {1 - 0.1 * i - 0.01 * j}]"
        for i, size in enumerate(("small", "large"), start=1)
        for j, kind in enumerate(("x", "y", "z"), start=1)
    )
    text = f'[properties.flag]\nstates = ["yes", "no"]\nparents = ["size", "kind"]\n[properties.flag.given]\n{rows}'
    flag = load_network(written(tmp_path, PROPERTY + text)).properties["flag"]
    assert isinstance(flag, CategoricalProperty)
    assert flag.table.shape == (2, 3, 2)
    np.testing.assert_allclose(flag.table[..., 0], [[0.11, 0.12, 0.13], [0.21, 0.22, 0.23]])


def test_prior_is_uniform_unless_given(tmp_path: Path) -> None:
    """A categorical property without parents and prior is uniform."""
    kind = load_network(written(tmp_path, PROPERTY)).properties["kind"]
    assert isinstance(kind, CategoricalProperty)
    np.testing.assert_allclose(kind.table, 1 / 3)


def test_rounded_probabilities_are_renormalised(tmp_path: Path) -> None:
    """A sum within 1e-6 of one is accepted, and is exactly one afterwards."""
    text = '[properties.a]\nstates = ["x", "y", "z"]\nprior = [0.3333333, 0.3333333, 0.3333333]'
    prop = load_network(written(tmp_path, text)).properties["a"]
    assert isinstance(prop, CategoricalProperty)
    assert prop.table.sum() == pytest.approx(1, abs=1e-15)


FAMILIES = {
    "normal": ("mean = 3\nsd = 2", stats.norm(3, 2)),
    "truncated-normal": ("mean = 3\nsd = 2\nlow = 0\nhigh = 5", stats.truncnorm(-1.5, 1, 3, 2)),
    "lognormal": ("median = 3\nlog_sd = 0.5", stats.lognorm(0.5, scale=3)),
    "gamma": ("shape = 3\nscale = 2", stats.gamma(3, scale=2)),
    "uniform": ("low = 1\nhigh = 5", stats.uniform(1, 4)),
    "student-t": ("location = 3\nscale = 2\ndof = 4", stats.t(4, 3, 2)),
}


@pytest.mark.parametrize("family", FAMILIES)
def test_families_by_name(family: str, tmp_path: Path) -> None:
    """Each family's parameters mean what their names say."""
    parameters, oracle = FAMILIES[family]
    prop = load_network(written(tmp_path, f'[properties.a]\nunit = "g"\nfamily = "{family}"\n{parameters}')).continuous[
        0
    ]
    x = np.linspace(0.5, 6, 12)
    np.testing.assert_allclose(prop.family.log_density(x), oracle.logpdf(x))


def test_parameters_of_the_property_hold_for_all_configurations(tmp_path: Path) -> None:
    """A shared parameter stands once, and a configuration's own one wins."""
    text = """
    [properties.a]
    unit = "g"
    family = "truncated-normal"
    low = 0
    sd = 1
    parents = ["size"]
    [properties.a.given]
    small = {mean = 3}
    large = {mean = 5, sd = 2}
    """
    prop = load_network(written(tmp_path, PROPERTY + text)).properties["a"]
    assert isinstance(prop, ContinuousProperty)
    expected = [stats.truncnorm(-3, np.inf, 3, 1).logpdf(2.0), stats.truncnorm(-2.5, np.inf, 5, 2).logpdf(2.0)]
    np.testing.assert_allclose(prop.family.log_density(np.array(2.0)), expected)


def test_derived_properties_may_follow_from_derived_ones(tmp_path: Path) -> None:
    """A formula over a derived property is one over continuous ones, in their units."""
    flat = 'family = "uniform"\nlow = 1\nhigh = 2'
    text = f"""
[properties.weight]
unit = "N"
formula = "mass * gravity"
[properties.mass]
unit = "g"
formula = "density * volume"
[properties.density]
unit = "kg/m^3"
{flat}
[properties.volume]
unit = "L"
{flat}
[properties.gravity]
unit = "m/s^2"
{flat}
"""
    network = load_network(written(tmp_path, text))
    weight = network.properties["weight"]
    assert isinstance(weight, DerivedProperty)
    assert [*network.properties][:2] == ["weight", "mass"]
    found = weight.formula.evaluate({"density": 500.0, "volume": 2.0, "gravity": 9.81})
    assert float(found) == pytest.approx(9.81)


def test_a_variant_extends_a_file(tmp_path: Path) -> None:
    """Tables merge deeply, values of the variant win, and lists are replaced."""
    text = '[properties.a]\nstates = ["x", "y"]\nprior = [0.5, 0.5]\n[actions.look]\ncost_s = 1\n'
    sensor = '[actions.look.sensor]\nproperty = "a"\nkind = "confusion"\n[actions.look.sensor.given]\n'
    written(tmp_path, text + sensor + "x = [1, 0]\ny = [0, 1]", "base.toml")
    path = written(
        tmp_path, 'extends = "base.toml"\n[actions.look]\ncost_s = 2\n[actions.look.sensor.given]\nx = [0.9, 0.1]'
    )
    look = load_network(path).actions["look"]
    assert isinstance(look.sensor, ConfusionSensor)
    assert look.cost_s == 2
    np.testing.assert_allclose(look.sensor.table, [[0.9, 0], [0.1, 1]])


def test_a_variant_may_extend_a_shipped_network_by_name(tmp_path: Path) -> None:
    """`extends` takes the name of a shipped network."""
    path = written(tmp_path, 'extends = "pantry"\n[actions.weigh]\ncost_s = 99')
    assert load_network(path).actions["weigh"].cost_s == 99


CSV_SENSOR = """
[actions.look]
cost_s = 1
[actions.look.sensor]
property = "size"
kind = "confusion"
csv = "sub/look.csv"
"""


def test_confusion_from_csv(tmp_path: Path) -> None:
    """Columns are true states in any order, rows are outcomes, the path starts at the network file."""
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "look.csv").write_text("truth,large,small\nbig,0.8,0.1\nlittle,0.2,0.9\n")
    sensor = load_network(written(tmp_path, PROPERTY + CSV_SENSOR)).actions["look"].sensor
    assert isinstance(sensor, ConfusionSensor)
    assert sensor.outcomes == ("big", "little")
    np.testing.assert_allclose(sensor.table, [[0.1, 0.8], [0.9, 0.2]])


def test_number_sensors(tmp_path: Path) -> None:
    """Scale, relative scale, degrees of freedom, both saturations and the offset arrive."""
    text = """
    [properties.a]
    unit = "g"
    family = "uniform"
    low = 0
    high = 9
    [actions.touch]
    cost_s = 0
    [actions.touch.sensor]
    property = "a"
    kind = "student-t"
    scale = 0.5
    relative_scale = 0.1
    dof = 4
    saturates_below = 1
    saturates_above = 8
    offset_sd = 0.2
    bias = -0.3
    """
    sensor = load_network(written(tmp_path, text)).actions["touch"].sensor
    assert isinstance(sensor, NumberSensor)
    assert (sensor.sd, sensor.relative_sd, sensor.low, sensor.high, sensor.offset_sd) == (0.5, 0.1, 1, 8, 0.2)
    assert sensor.bias == -0.3
    assert sensor.noise == StudentTNoise(4.0)


def test_derived_truth_follows_from_the_formula() -> None:
    """A derived true value that is not given is computed, and is as well known as its inputs."""
    truth = load_network("pantry").objects["half_water_bottle"].truth
    assert truth["contents"].value == pytest.approx(260)
    assert truth["contents"].status == "assumed"


@pytest.mark.parametrize("name", shipped_networks())
def test_shipped_networks_load_fast(name: str) -> None:
    """Reading a shipped network takes a few hundredths of a second at most (15 ms on a quiet machine)."""
    load_network(name)
    times = []
    for _ in range(5):
        start = time.perf_counter()
        load_network(name)
        times.append(time.perf_counter() - start)
    assert min(times) < 0.05


@pytest.mark.parametrize("name", shipped_networks())
def test_tables_of_shipped_networks_are_distributions(name: str) -> None:
    """Every table and confusion matrix of a shipped network sums to one."""
    network = load_network(name)
    for prop in network.categorical:
        np.testing.assert_allclose(prop.table.sum(axis=-1), 1, atol=1e-12)
    for action in network.actions.values():
        if isinstance(action.sensor, ConfusionSensor):
            np.testing.assert_allclose(action.sensor.table.sum(axis=0), 1, atol=1e-12)
