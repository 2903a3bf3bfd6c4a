"""Fitted networks as files."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from palpate.fitting.data import Data, Source
from palpate.fitting.documenting import Provenance, document
from palpate.fitting.fit import fit
from palpate.fitting.parts import Fitted
from palpate.fitting.settings import Settings
from palpate.fitting.template import Template, read_template
from palpate.network.digest import digest
from palpate.network.model import Network
from palpate.network.reading import load_network, read_document
from palpate.network.sensors import NumberSensor
from palpate.network.writing import to_toml
from tests.fitting.made_up import WORKSHOP, drawn, network_of, workshop
from tests.fitting.test_template import BLANK

MADE = Provenance("workshop.toml", "palpate network fit", "9.9", "2024-05-01")
SOURCE = Source("csv", "objects.csv", "00", 3)


def written(folder: Path, template: Template, count: int = 60, keep: tuple[str, ...] = ()) -> tuple[Fitted, Path]:
    chosen = Settings(keep=keep)
    data = Data.of(drawn(_whole(template, folder), count, 1), [SOURCE], ["something odd"])
    found = fit(template, data.specimens, chosen)
    path = folder / "own.toml"
    path.write_text(to_toml(document(template, found, data, chosen, MADE, "own")), encoding="utf-8")
    return found, path


def _whole(template: Template, folder: Path) -> Network:
    return load_network(workshop(folder)) if template.blank_properties else template.network


@pytest.mark.parametrize("name", ["household", "household-filled", "pantry", "whole", "blank"])
def test_the_file_is_the_fitted_network(name: str, tmp_path: Path) -> None:
    """What is written is read as the network that was fitted, in another folder, and without the template's objects."""
    path = {"whole": workshop, "blank": lambda folder: workshop(folder, BLANK)}.get(name)
    template = read_template(path(tmp_path) if path else name)
    found, file = written(tmp_path, template)
    network = load_network(file)
    # probabilities are divided by their sum when a file is read
    for one, other in zip(network.categorical, found.network.categorical, strict=True):
        np.testing.assert_allclose(one.table, other.table, atol=1e-8)
    for this, that in zip(network.continuous, found.network.continuous, strict=True):
        for key, value in vars(this.family).items():
            np.testing.assert_array_equal(value, getattr(that.family, key))
    assert list(network.actions) == list(found.network.actions)
    for action in network.actions.values():
        assert action.cost_s == template.network.actions[action.name].cost_s
        for key in ("sd", "relative_sd", "offset_sd", "bias", "low", "high", "noise", "outcomes", "repeat_probability"):
            assert getattr(action.sensor, key, None) == getattr(found.network.actions[action.name].sensor, key, None)
    assert not network.objects


def test_provenance_and_counts(tmp_path: Path) -> None:
    """The file says what it was made from, with which settings, what was odd, and how often what was seen."""
    template = read_template(workshop(tmp_path))
    found, file = written(tmp_path, template, keep=("hardness",))
    tables = read_document(file).tables
    assert tables["provenance"] == {
        "made_by": "palpate 9.9",
        "command": "palpate network fit",
        "date": "2024-05-01",
        "like": "workshop.toml",
        "like_digest": template.digest,
        "objects": 60,
        "pseudo_count": 0.2,
        "kept": ["hardness"],
        "data": [{"kind": "csv", "name": "objects.csv", "sha256": "00", "items": 3}],
        "notices": ["something odd"],
    }
    properties, actions = tables["properties"], tables["actions"]
    assert isinstance(properties, dict)
    assert isinstance(actions, dict)
    counts = found.properties["metal"].counts
    assert counts is not None
    assert [*properties["metal"]["counts"].values()] == counts.tolist()
    assert sum(properties["kind"]["counts"]) == 60
    assert "counts" not in properties["hardness"]
    assert actions["weigh"]["sensor"]["counts"] == {"objects": 60, "readings": 120}
    assert "mean error" in actions["weigh"]["sensor"]["source"]
    assert tables["source"] == "Fitted to 60 objects; [provenance] says how"


def test_shared_parameters_become_those_of_each_state(tmp_path: Path) -> None:
    """A parameter that stood once for all states stands with each, where it is estimated; limits stay."""
    template = read_template("pantry")
    _, file = written(tmp_path, template, 200)
    temperature = read_document(file).section("properties").section("temperature").tables
    assert temperature["dof"] == 5
    fill = read_document(file).section("properties").section("fill").tables
    assert fill["given"] == {"avocado": {"low": 80}, "peach": {"low": 80}, "water-bottle": {}, "juice-bottle": {}}
    assert fill["high"] == 100


def test_a_matrix_of_another_file_is_taken_in(tmp_path: Path) -> None:
    """A confusion matrix in a CSV file stands in the new file itself, fitted or kept."""
    for keep in ((), ("sniff",)):
        _, file = written(tmp_path, read_template("pantry"), keep=keep)
        sniff = read_document(file).section("actions").section("sniff").section("sensor").tables
        assert "csv" not in sniff
        assert "given" in sniff


def test_a_fit_can_be_a_template(tmp_path: Path) -> None:
    """A fitted network is fitted again; without data it stays as it is, with the counts of the first time."""
    template = read_template(workshop(tmp_path))
    _, file = written(tmp_path, template)
    again = read_template(file)
    found = fit(again, [])
    tables = document(again, found, Data.of([]), Settings(), MADE, "again")
    path = tmp_path / "again.toml"
    path.write_text(to_toml(tables), encoding="utf-8")
    assert digest(load_network(path)) == digest(load_network(file))
    assert tables["properties"]["kind"]["counts"] == read_document(file).tables["properties"]["kind"]["counts"]  # type: ignore[index]


def test_whole_sensors_are_written(tmp_path: Path) -> None:
    """Bias, limits and what repetitions share stand in the file, and nothing that the template had in their place."""
    real = network_of(tmp_path)
    for name, changed in {"look": {"repeat_probability": 0.8}, "weigh": {"bias": -3.0, "offset_sd": 1.5}}.items():
        sensor = replace(real.actions[name].sensor, **changed)  # type: ignore[arg-type]
        real = real.with_action(replace(real.actions[name], sensor=sensor))
    data = Data.of(drawn(real, 80, 1, repeats=3), [SOURCE])
    text = WORKSHOP.replace("saturates_above = 35", "bias = 7").replace('"else"]', '"else"]\nrepeat_probability = 0.1')
    template = read_template(workshop(tmp_path, text))
    settings = Settings(keep=tuple(template.network.properties), whole_sensors=True)
    found = fit(template, data.specimens, settings)
    path = tmp_path / "own.toml"
    path.write_text(to_toml(document(template, found, data, settings, MADE, "own")), encoding="utf-8")
    look, weigh = (load_network(path).actions[name].sensor for name in ("look", "weigh"))
    assert look.repeat_probability == pytest.approx(0.8, abs=0.1)  # type: ignore[union-attr]
    assert isinstance(weigh, NumberSensor)
    assert vars(weigh) == vars(found.network.actions["weigh"].sensor)
    assert weigh.bias == pytest.approx(-3, abs=1)
    assert weigh.offset_sd == pytest.approx(1.5, rel=0.5)
    assert weigh.high == 35.0
    assert read_document(path).tables["source"] == "Sensors fitted to 80 objects; [provenance] says how"
