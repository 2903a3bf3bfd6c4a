"""Models of images: learned by PyTorch where there is one, and those that ship in any case."""

from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from palpate.errors import PalpateError
from palpate.estimators.vision import Model, OnnxClassifier, read_model
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Posterior
from palpate.robots.mujoco.estimates import PICTURES
from palpate.robots.mujoco.training.held_out import Examples
from palpate.robots.mujoco.training.learning import Schedule, compact, fit, resnet34, write_onnx
from palpate.robots.mujoco.training.nothing import noise
from palpate.robots.mujoco.training.seeing import seen, train_model, write_model

needs_torch = pytest.mark.skipif(find_spec("torch") is None, reason="PyTorch (extra sound) is not installed")
# PyTorch's exporter warns of its own insides
quiet = pytest.mark.filterwarnings("ignore::FutureWarning", "ignore::DeprecationWarning", "ignore::UserWarning")
STATES = ("dark", "light")


def shades(groups: int = 28, size: tuple[int, int] = (96, 48)) -> Examples:
    """Dark and light images, two of each group."""
    rng = np.random.default_rng(1)
    numbers = np.repeat(np.arange(groups), 2)
    levels = np.where(numbers % 2, 200, 60)[:, None, None, None]
    images = np.clip(levels + rng.normal(0, 20, (len(numbers), size[1], size[0], 3)), 0, 255).astype(np.uint8)
    return Examples(images, np.array(STATES)[numbers % 2], numbers)


@needs_torch
@quiet
def test_what_is_learned_is_written_and_told_alike(tmp_path: Path) -> None:
    """A model trained in a few steps tells dark from light on groups it has not met; the seed decides all."""
    trained = train_model(
        shades(), STATES, tmp_path / "shades.onnx", 1, source="shades", schedule=Schedule(12, 8, 1e-2)
    )
    assert trained.scores.balanced_accuracy > 0.9
    read = read_model(tmp_path / "shades.toml")
    assert (read.labels, read.source, read.temperature) == (STATES, "shades", trained.model.temperature)
    assert sum(read.training_prior.values()) == pytest.approx(1, abs=1e-5) if read.training_prior else False
    again = train_model(shades(), STATES, tmp_path / "again.onnx", 1, source="shades", schedule=Schedule(12, 8, 1e-2))
    np.testing.assert_allclose(
        seen(again.model, shades(4)), seen(trained.model, shades(4)), atol=1e-4, err_msg="the seed decides all"
    )


@needs_torch
@quiet
def test_the_papers_network_learns_and_is_written(tmp_path: Path) -> None:
    """One step of a ResNet34 on tiny images changes it, and its file gives the same scores as itself."""
    import torch

    try:
        resnet34(2)
    except PalpateError as error:
        pytest.skip(str(error))
    examples = shades(4, (32, 32))
    targets = (examples.labels == "light").astype(np.int64)
    net = fit(lambda: resnet34(2), examples.inputs.astype(np.uint8), targets, 1, Schedule(1, 4))
    write_onnx(net, (32, 32), tmp_path / "ears.onnx")
    image = examples.inputs[0].astype(np.uint8)
    with torch.no_grad():
        scores = net(torch.from_numpy(((image.astype(np.float32) / 255 - 0.5) / 0.5).transpose(2, 0, 1)[None]))
    wanted = torch.softmax(scores, 1).numpy().ravel()
    outcome = OnnxClassifier(Model(tmp_path / "ears.onnx", STATES)).outcome(image)
    assert isinstance(outcome, Posterior)
    np.testing.assert_allclose(list(outcome.probabilities.values()), wanted, atol=1e-4)


@pytest.mark.skipif(find_spec("torch") is not None, reason="PyTorch is installed")
def test_without_pytorch_the_error_says_what_to_install() -> None:
    """Training without PyTorch is one sentence."""
    for build in (lambda: compact(2, (160, 120)), lambda: resnet34(2)):
        with pytest.raises(PalpateError, match=r"palpate\[sound\]"):
            build()


def test_what_is_written_of_a_model_is_read_again(tmp_path: Path) -> None:
    """Labels, prior, temperature and source come back as they were, quotes and all."""
    model = Model(
        tmp_path / "a.onnx", ("a", 'b"c'), training_prior={"a": 0.25, 'b"c': 0.75}, temperature=1.5, source='say "a"\n'
    )
    write_model(model)
    assert read_model(tmp_path / "a.toml") == model


@pytest.mark.parametrize(("path", "what"), list(zip(PICTURES, ("category", "material"), strict=True)))
def test_the_shipped_models_know_the_networks_states(path: Path, what: str) -> None:
    """Labels and prior are of the states; the file is small and says how it was made."""
    model, measured = read_model(path), load_network("household").properties[what]
    assert isinstance(measured, CategoricalProperty)
    assert model.labels == (*measured.states, "nothing")
    assert model.training_prior is not None
    assert set(model.training_prior) == set(measured.states)
    assert "palpate.robots.mujoco.training pictures" in model.source
    assert model.path.stat().st_size < 200_000


@pytest.mark.parametrize("path", PICTURES)
def test_the_shipped_models_are_not_sure_of_noise(path: Path) -> None:
    """Flat images are failures, and so is nearly all noise, white or smooth, grey or in colour, of any size."""
    eye, rng = OnnxClassifier(read_model(path)), np.random.default_rng(8)
    assert isinstance(eye.outcome(np.full((480, 640, 3), 90, np.uint8)), Failed)
    refused = [isinstance(eye.outcome(noise((120, 160), rng)), Failed) for _ in range(60)]
    assert np.mean(refused) > 0.9
    white = rng.integers(0, 256, (480, 640, 3)).astype(np.uint8)
    assert isinstance(eye.outcome(white), Failed)
