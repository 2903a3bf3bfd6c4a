"""Densities given parents: the truth within its error, what few values give, and values that are wrong."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from palpate.fitting.data import Specimen
from palpate.fitting.densities import fit_density
from palpate.fitting.parts import PropertyPart
from palpate.network.families import Gamma, LogNormal, Normal
from palpate.network.model import Network
from palpate.network.properties import ContinuousProperty
from palpate.network.reading import load_network
from tests.fitting.made_up import drawn, network_of


@pytest.fixture
def network(tmp_path: Path) -> Network:
    return network_of(tmp_path)


def fitted(network: Network, name: str, specimens: Sequence[Specimen]) -> tuple[ContinuousProperty, PropertyPart]:
    prop = network.property(name)
    assert isinstance(prop, ContinuousProperty)
    return fit_density(network, prop, specimens)


def of_metal(values: dict[str, list[float]]) -> list[Specimen]:
    return [
        Specimen(f"{metal}{place}", {"metal": metal, "density": value})
        for metal, column in values.items()
        for place, value in enumerate(column)
    ]


def test_the_truth_is_within_its_error(network: Network) -> None:
    """Of 600 objects, locations are within 4.5 standard errors of the truth and spreads within 4.5 of theirs."""
    specimens = drawn(network, 600, 1, repeats=0)
    for name, location, spread in (("density", "mean", "sd"), ("volume", "median", "log_sd")):
        prop, part = fitted(network, name, specimens)
        true = network.property(name)
        assert isinstance(true, ContinuousProperty)
        assert part.counts is not None
        assert part.objects == 600
        found, was = (getattr(p.family, location) for p in (prop, true))
        if location == "median":
            found, was = np.log(found), np.log(was)
        sd = getattr(true.family, spread)
        assert (np.abs(found - was) < 4.5 * sd / np.sqrt(part.counts)).all()
        assert (np.abs(np.log(getattr(prop.family, spread) / sd)) < 4.5 / np.sqrt(2 * part.counts)).all()


def test_a_gamma_without_parents(network: Network) -> None:
    """Mean and SD over mean of a gamma come out within 4.5 standard errors."""
    prop, part = fitted(network, "hardness", drawn(network, 500, 2, repeats=0))
    assert isinstance(prop.family, Gamma)
    assert part.counts == 500
    assert float(prop.family.shape * prop.family.scale) == pytest.approx(1.8, abs=4.5 * 0.6 / np.sqrt(500))
    assert float(prop.family.shape) == pytest.approx(9, rel=4.5 * np.sqrt(2 / 500))


def test_truncation_of_the_published_volumes() -> None:
    """Plates, whose mean before truncation is 0 cm^3, get a median near the true one, which is 10 cm^3."""
    network = load_network("household")
    rng = np.random.default_rng(0)
    specimens = [
        Specimen(f"{i:03d}", {"category": "plate", "volume": v}) for i, v in enumerate(abs(rng.normal(0, 15, 400)))
    ]
    prop, _ = fitted(network, "volume", specimens)
    plate = network.categorical[0].states.index("plate")
    median = float(prop.family.quantile(np.array(0.5))[plate])
    assert median == pytest.approx(15 * 0.6745, rel=0.15)


def test_states_without_objects_have_the_density_of_all(network: Network) -> None:
    """A state without objects has mean and SD of all values, and the part says so."""
    values = {"steel": [7.0, 7.5, 8.0, 8.5], "brass": [9.0, 9.4, 9.9]}
    prop, part = fitted(network, "density", of_metal(values))
    everything = np.concatenate(list(values.values()))
    assert isinstance(prop.family, Normal)
    assert prop.family.mean[2] == pytest.approx(everything.mean(), rel=1e-3)
    assert prop.family.sd[2] == pytest.approx(everything.std(), rel=1e-3)
    assert part.counts is not None
    assert part.counts.tolist() == [4, 3, 0]
    assert part.note == "1 of 3 configurations without objects: the density of all"


def test_a_single_value_has_the_spread_of_the_others(network: Network) -> None:
    """A state with one object has its value as mean, drawn a little to the others, and the spread of the others."""
    values = {"steel": [7.0, 7.1, 7.2, 7.1, 7.0], "brass": [8.5, 8.6, 8.4, 8.5], "zinc": [12.0]}
    prop, _ = fitted(network, "density", of_metal(values))
    assert isinstance(prop.family, Normal)
    assert 11.9 < prop.family.mean[2] < 12.0
    assert 0.05 < prop.family.sd[2] < 0.5


def test_many_values_speak_for_themselves(network: Network) -> None:
    """The more values a state has, the nearer its mean and SD are to those of its values alone."""
    rng = np.random.default_rng(3)
    distances = []
    for count in (3, 30, 300):
        x = rng.normal(8, 0.1, count)
        x = 8 + 0.1 * (x - x.mean()) / x.std()
        prop, _ = fitted(network, "density", of_metal({"steel": x.tolist(), "brass": (20 + 5 * x).tolist()}))
        assert isinstance(prop.family, Normal)
        distances.append(abs(np.log(prop.family.sd[0] / 0.1)))
        assert prop.family.mean[0] == pytest.approx(8, abs=0.02)
    assert distances == sorted(distances, reverse=True)
    assert distances[-1] < 0.02


def test_wrong_values_are_named_and_change_little(network: Network) -> None:
    """With values in a wrong unit for a tenth of the objects, the estimates are nearly those without these objects."""
    specimens = drawn(network, 200, 4, repeats=0)
    wrong = {one.name for one in specimens[::10]}
    spoilt = [
        replace(one, truth={**one.truth, "volume": 1000 * float(one.truth["volume"])}) if one.name in wrong else one
        for one in specimens
    ]
    clean, _ = fitted(network, "volume", [one for one in specimens if one.name not in wrong])
    found, part = fitted(network, "volume", spoilt)
    assert wrong <= set(part.left_out)
    assert len(part.left_out) <= len(wrong) + 2
    assert isinstance(found.family, LogNormal)
    assert isinstance(clean.family, LogNormal)
    np.testing.assert_allclose(np.log(found.family.median / clean.family.median), 0, atol=0.05)
    np.testing.assert_allclose(np.log(found.family.log_sd / clean.family.log_sd), 0, atol=0.1)


def test_the_order_of_objects_does_not_matter(network: Network) -> None:
    """Objects in any order give the same numbers to the last bit."""
    specimens = drawn(network, 60, 5, repeats=0)
    one, other = (fitted(network, "density", order)[0] for order in (specimens, specimens[::-1]))
    for key in ("mean", "sd"):
        assert getattr(one.family, key).tolist() == getattr(other.family, key).tolist()


@pytest.mark.parametrize("values", [{}, {"steel": [7.0, 8.0]}, {"steel": [7.0, 7.0, 7.0]}])
def test_too_few_values_leave_the_template(network: Network, values: dict[str, list[float]]) -> None:
    """Fewer than three values, or values that are all the same, are no data."""
    prop, part = fitted(network, "density", of_metal(values))
    assert prop is network.property("density")
    assert part.counts is None


def test_a_uniform_keeps_its_limits() -> None:
    """Limits are what is known; the objects within them are counted, those outside are not."""
    network = load_network("pantry")
    specimens = [Specimen(str(v), {"kind": "peach", "fill": v}) for v in (10.0, 85.0, 90.0, 99.0)]
    prop, part = fitted(network, "fill", specimens)
    assert prop is network.property("fill")
    assert part.counts is not None
    assert part.counts.tolist() == [0, 3, 0, 0]
