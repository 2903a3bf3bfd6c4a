"""Classifiers in the ONNX format: labels, maps, and files that do not fit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper

from palpate.estimators.signals import EstimatorError
from palpate.estimators.vision import Model, OnnxClassifier, read_model
from palpate.network.admission import admit
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Posterior

LABELS = ("red thing", "green thing", "blue thing")


def write_model(path: Path, *, labels: int = 3, softmax: bool = True, size: int = 8) -> None:
    """A model whose score of a label is ten times the mean of a colour."""
    pool = helper.make_node("GlobalAveragePool", ["image"], ["pooled"])
    flat = helper.make_node("Flatten", ["pooled"], ["flat"])
    product = helper.make_node("MatMul", ["flat", "weights"], ["scores"])
    last = (
        helper.make_node("Softmax", ["scores"], ["out"])
        if softmax
        else helper.make_node("Identity", ["scores"], ["out"])
    )
    weights = numpy_helper.from_array((10 * np.eye(3, labels)).astype(np.float32), "weights")
    graph = helper.make_graph(
        [pool, flat, product, last],
        "colours",
        [helper.make_tensor_value_info("image", TensorProto.FLOAT, [1, 3, size, size])],
        [helper.make_tensor_value_info("out", TensorProto.FLOAT, [1, labels])],
        [weights],
    )
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=10)
    onnx.checker.check_model(model)
    onnx.save(model, path)


@pytest.fixture
def model(tmp_path: Path) -> Model:
    write_model(tmp_path / "colours.onnx")
    return Model(tmp_path / "colours.onnx", LABELS)


def coloured(channel: int, shape: tuple[int, int] = (48, 64)) -> np.ndarray:
    """An image that is mostly of one colour."""
    image = np.random.default_rng(0).integers(0, 60, (*shape, 3)).astype(np.uint8)
    image[..., channel] += 150
    return image


@pytest.mark.parametrize("softmax", [True, False])
@pytest.mark.parametrize("shape", [(8, 8), (48, 64), (480, 640), (1, 1)])
def test_an_image_of_any_size_gives_probabilities(
    tmp_path: Path, model: Model, softmax: bool, shape: tuple[int, int]
) -> None:
    """Scores or probabilities, they sum to one, and the label is that of what is seen."""
    write_model(model.path, softmax=softmax)
    for channel, label in enumerate(LABELS):
        outcome = OnnxClassifier(model).outcome(coloured(channel, shape))
        assert isinstance(outcome, Posterior)
        assert sum(outcome.probabilities.values()) == pytest.approx(1)
        assert max(outcome.probabilities, key=lambda name: outcome.probabilities[name]) == label


def test_scores_are_those_of_the_model(model: Model) -> None:
    """By hand: the mean of each colour, centred and scaled, ten times, through a softmax."""
    image = coloured(1, (8, 8))
    scores = 10 * ((image / 255).mean(axis=(0, 1)) - 0.5) / 0.5
    wanted = np.exp(scores - scores.max()) / np.exp(scores - scores.max()).sum()
    outcome = OnnxClassifier(model).outcome(image)
    assert isinstance(outcome, Posterior)
    np.testing.assert_allclose([outcome.probabilities[label] for label in LABELS], wanted, atol=1e-4)


def test_labels_are_mapped_and_unknown_ones_kept(model: Model) -> None:
    """Two labels of one state add up; a label that no network knows is left to those who know what to do with it."""
    mapped = replace(model, label_map={"red thing": "mug", "green thing": "mug"})
    outcome = OnnxClassifier(mapped).outcome(coloured(1))
    assert isinstance(outcome, Posterior)
    assert outcome.probabilities["mug"] > 0.9
    assert set(outcome.probabilities) == {"mug", "blue thing"}
    admit(load_network("household"), "cat-vision", outcome)


def test_a_label_may_mean_that_nothing_is_seen(model: Model) -> None:
    """Where it is the likeliest, looking failed; elsewhere it does not count; it must be one of the labels."""
    blind = replace(model, nothing="red thing")
    assert isinstance(OnnxClassifier(blind).outcome(coloured(0)), Failed)
    outcome = OnnxClassifier(blind).outcome(coloured(1))
    assert isinstance(outcome, Posterior)
    assert set(outcome.probabilities) == set(blind.tells) == {"green thing", "blue thing"}
    assert sum(outcome.probabilities.values()) == pytest.approx(1)
    with pytest.raises(EstimatorError, match="expected one of its labels"):
        replace(model, nothing="void")


def test_an_image_of_nothing_fails(model: Model) -> None:
    """One colour shows nothing, and is no reason to be sure of anything."""
    outcome = OnnxClassifier(model).outcome(np.full((20, 20, 3), 200, np.uint8))
    assert isinstance(outcome, Failed)


@pytest.mark.parametrize(
    "image",
    [
        np.zeros((4, 4)),
        np.zeros((4, 4, 4), np.uint8),
        np.zeros((0, 4, 3), np.uint8),
        np.zeros((4, 4, 3)),
        np.zeros(3, np.uint8),
    ],
)
def test_wrong_images_are_errors(model: Model, image: np.ndarray) -> None:
    """Grey, transparent, empty and floating images are refused with what was found."""
    with pytest.raises(EstimatorError, match="expected uint8"):
        OnnxClassifier(model).outcome(image)


def test_models_that_do_not_fit_are_errors(tmp_path: Path, model: Model) -> None:
    """Another number of labels, no file, rubbish, and half a model: one sentence each."""
    with pytest.raises(EstimatorError, match="gives 3 numbers, expected one for each of 2 labels"):
        OnnxClassifier(replace(model, labels=LABELS[:2]))
    with pytest.raises(EstimatorError, match="no such file"):
        OnnxClassifier(replace(model, path=tmp_path / "none.onnx"))
    whole = model.path.read_bytes()
    for content in (b"", b"rubbish", whole[: len(whole) // 2], whole[20:]):
        model.path.write_bytes(content)
        with pytest.raises(EstimatorError):
            OnnxClassifier(model)


def test_a_toml_file_says_what_the_model_does_not(tmp_path: Path, model: Model) -> None:
    """The fields are read from beside the model; unknown keys and missing ones are named."""
    path = tmp_path / "colours.toml"
    path.write_text(
        'path = "colours.onnx"\nlabels = ["red thing", "green thing", "blue thing"]\ntemperature = 2.0\n'
        '[label_map]\n"red thing" = "mug"\n'
    )
    read = read_model(path)
    assert read == replace(model, temperature=2.0, label_map={"red thing": "mug"})
    for text, told in (("x = 1", "unknown key"), ('labels = ["a"]', "missing"), ("path = ", "cannot be read")):
        path.write_text(text)
        with pytest.raises(EstimatorError, match=told):
            read_model(path)


@pytest.mark.parametrize(
    ("name", "wrong"),
    [
        ("labels", '"red"'),
        ("labels", "[1, 2, 3]"),
        ("mean", "0.5"),
        ("mean", "[0.5, 0.5]"),
        ("sd", "[0.2, 0.0, 0.2]"),
        ("sd", '"a"'),
        ("temperature", "0.0"),
        ("temperature", '"warm"'),
        ("label_map", "3"),
        ("training_prior", "{}"),
        ("training_prior", "{red = -1.0}"),
    ],
)
def test_a_toml_file_of_other_kinds_is_an_error(tmp_path: Path, model: Model, name: str, wrong: str) -> None:
    """What cannot be is said when the file is read, and not by the first image or by the belief."""
    right = {"path": f'"{model.path.name}"', "labels": '["red", "green", "blue"]'}
    lines = [f"{key} = {value}" for key, value in {**right, name: wrong}.items()]
    (tmp_path / "model.toml").write_text("\n".join(lines))
    with pytest.raises(EstimatorError, match=f"{name} = "):
        read_model(tmp_path / "model.toml")
