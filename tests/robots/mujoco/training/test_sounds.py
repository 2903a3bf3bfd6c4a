"""The classifier of knocks: trained the same each time, sure only of what it can tell."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from palpate.errors import PalpateError
from palpate.estimators.classifier import Classifier
from palpate.estimators.sound import FEATURES
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.robots.mujoco.estimates import SOUNDS
from palpate.robots.mujoco.reading import read_substances
from palpate.robots.mujoco.training import sounds
from palpate.robots.mujoco.training.__main__ import main
from palpate.robots.mujoco.training.held_out import Examples, scores
from palpate.robots.mujoco.training.tables import draw_plates, read_measured


@pytest.fixture(scope="module")
def shipped() -> Classifier:
    return Classifier.load(SOUNDS)


def test_the_shipped_classifier_knows_the_networks_materials(shipped: Classifier) -> None:
    """Its labels are the states, its features those that are made, and it says how it was trained."""
    material = load_network("household").properties["material"]
    assert isinstance(material, CategoricalProperty)
    assert set(shipped.labels) == set(material.states)
    assert shipped.names == FEATURES
    assert "palpate.robots.mujoco.training sounds" in shipped.source
    assert SOUNDS.stat().st_size < 20_000


def test_the_shipped_classifier_tells_plates_that_it_has_not_met(shipped: Classifier) -> None:
    """On new plates it is right far more often than by chance, and worth more than saying nothing."""
    plates = draw_plates(read_substances(), 5, np.random.default_rng(77))
    met = sounds.record(plates, 1, np.random.default_rng(78))
    found = scores(sounds.answers(shipped, met, shipped.labels), met.labels, shipped.labels)
    assert found.balanced_accuracy > 0.6
    assert found.gain_bits > 1.5


def test_training_twice_gives_the_same_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The seed decides everything; the report has both tables."""
    for name in ("one.json", "two.json"):
        assert main(["sounds", str(tmp_path / name), "--each", "4", "--knocks", "2"]) == 0
    assert (tmp_path / "one.json").read_bytes() == (tmp_path / "two.json").read_bytes()
    told = capsys.readouterr().out
    assert "Plates held out, 32 of them: balanced accuracy" in told
    assert "The bench's own objects: balanced accuracy" in told


def test_what_tells_nothing_is_worth_nothing_and_not_trusted() -> None:
    """Trained on features that have nothing to do with the labels, it ends near the prior, and hot."""
    rng = np.random.default_rng(3)
    groups = np.repeat(np.arange(40), 4)
    labels = np.array(["glass", "wood"])[groups % 2]
    # copies of a group resemble each other: only holding out whole groups shows that they tell nothing
    inputs = rng.standard_normal((40, len(FEATURES)))[groups] + 0.01 * rng.standard_normal((160, len(FEATURES)))
    trained = sounds.train(Examples(inputs, labels, groups), rng)
    assert trained.classifier.temperature > 2
    assert trained.scores.gain_bits == pytest.approx(0, abs=0.25)


def test_measured_tables_without_the_package_are_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Without the package the command says which one is needed."""
    monkeypatch.setattr("palpate.robots.mujoco.training.tables.find_spec", lambda _: None)
    assert main(["measured", str(SOUNDS)]) == 2
    assert "package tdw, which is not installed" in capsys.readouterr().err


@pytest.mark.skipif(find_spec("tdw") is None, reason="the package tdw is not installed")
def test_measured_tables_are_hardly_told() -> None:
    """The package has two tables or more of each material, and they are told little better than by chance."""
    tables = read_measured()
    counts = {table.label: sum(other.label == table.label for other in tables) for table in tables}
    assert min(counts.values()) >= 2
    found = sounds.train(sounds.record(tables, 4, np.random.default_rng(1)), np.random.default_rng(1), folds=2)
    assert found.scores.balanced_accuracy < 0.5


def test_plates_that_cannot_be_heard_are_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    """A table of which no knock stands out from the noise is said, and not left out quietly."""
    plates = draw_plates(read_substances(), 1, np.random.default_rng(1))[:1]
    monkeypatch.setattr(type(plates[0]), "sound", lambda *_: np.random.default_rng(0).standard_normal(44100) / 10)
    with pytest.raises(PalpateError, match="not one of 2 knocks"):
        sounds.record(plates, 2, np.random.default_rng(1))
