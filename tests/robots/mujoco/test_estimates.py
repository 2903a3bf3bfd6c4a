"""From the bench's signals to outcomes: which models serve which actions."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.estimators.classifier import Classifier
from palpate.estimators.vision import OnnxClassifier, read_model
from palpate.network.admission import admit
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Posterior, Reading
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.estimates import PICTURES, SOUNDS, Ears, Eyes, Hand, estimates
from palpate.robots.mujoco.knocking import knock
from palpate.robots.mujoco.looking import look
from palpate.robots.mujoco.reading import bench_object
from palpate.robots.signals import ImageSignals, SoundSignals, SqueezeSignals


def test_the_shipped_models_serve_what_they_know() -> None:
    """All five actions of the household are served; of a network whose states no model knows, none that needs one."""
    assert set(estimates(load_network("household"))) == set(load_network("household").actions)
    assert not {"mat-sound", "cat-vision", "mat-vision"} & set(estimates(load_network("pantry")))


def test_eyes_for_other_labels_are_refused() -> None:
    """A model of categories for an action that measures materials is an error; its own action is served."""
    network, eye = load_network("household"), OnnxClassifier(read_model(PICTURES[0]))
    with pytest.raises(BenchError, match=r"'mat-vision': labels bottle.* expected states of 'material'"):
        estimates(network, eyes=Eyes({"mat-vision": eye}))
    assert "mat-vision" not in estimates(network, eyes=Eyes({"cat-vision": eye}))


def test_a_look_on_the_bench_tells_the_category(drawing: None) -> None:
    """A mug looks like a mug; the outcome is one that the network takes; a picture of noise fails."""
    network = load_network("household")
    eyes = estimates(network)
    with Bench(bench_object(network, "ceramic_mug"), rng=np.random.default_rng(1)) as bench:
        signals = look(bench)
    for action, wanted in (("cat-vision", "mug"), ("mat-vision", "ceramic")):
        outcome = eyes[action](signals)
        assert isinstance(outcome, Posterior)
        assert max(outcome.probabilities, key=lambda name: outcome.probabilities[name]) == wanted
        admit(network, action, outcome)
    noise = np.random.default_rng(2).integers(0, 256, (480, 640, 3)).astype(np.uint8)
    assert isinstance(eyes["cat-vision"](ImageSignals(noise)), Failed)


def test_a_model_of_other_labels_is_refused() -> None:
    """A classifier none of whose labels is a state is an error that names both."""
    strange = replace(Classifier.load(SOUNDS), labels=tuple("abcdefgh"))
    with pytest.raises(BenchError, match=r"'mat-sound': labels a, b, .* expected states of 'material': ceramic"):
        estimates(load_network("household"), ears=Ears(strange))


def test_a_knock_on_the_bench_tells_the_material() -> None:
    """A ceramic mug sounds of ceramic; the outcome is one that the network takes."""
    network = load_network("household")
    with Bench(bench_object(network, "ceramic_mug"), rng=np.random.default_rng(1)) as bench:
        outcome = estimates(network)["mat-sound"](knock(bench))
    assert isinstance(outcome, Posterior)
    assert max(outcome.probabilities, key=lambda name: outcome.probabilities[name]) == "ceramic"
    admit(network, "mat-sound", outcome)


@pytest.mark.parametrize("kind", ["silence", "noise", "short", "hum"])
def test_rubbish_is_never_told(kind: str) -> None:
    """Silence, noise alone, too short a sound and a tone that lasts are failures with a reason."""
    rng = np.random.default_rng(2)
    samples = {
        "silence": np.zeros(44100),
        "noise": 0.1 * rng.standard_normal(44100),
        "short": 0.1 * rng.standard_normal(100),
        "hum": 0.4 * np.sin(2 * np.pi * 180 * np.arange(44100) / 44100),
    }[kind]
    outcome = estimates(load_network("household"))["mat-sound"](SoundSignals(samples, 44100.0, 0.0))
    assert isinstance(outcome, Failed)
    assert outcome.reason


def test_the_sd_of_an_elasticity_knows_that_the_width_is_not_exact() -> None:
    """What is told of the object at rest has an error as well: half a millimetre is most of the SD of stiff things."""
    rng, scores = np.random.default_rng(9), []
    true_mm = np.linspace(62, 44, 60)
    for _ in range(200):
        gap_mm = 85 - np.round((85 - true_mm + rng.uniform(0, 0.37)) / 0.37) * 0.37
        force_n = 1.5 * np.maximum(0, 55 - true_mm) + rng.normal(0, 0.15, 60)
        counts = np.round((85 - gap_mm) / 0.37).astype(np.int64)
        squeezed = SqueezeSignals(np.arange(60) / 50, gap_mm, force_n, counts, 1500.0, 55 + rng.normal(0, 0.5))
        outcome = Hand().elasticity(squeezed)
        assert isinstance(outcome, Reading)
        assert outcome.sd is not None
        scores.append((outcome.value - 55) / outcome.sd)
    assert 0.75 < np.std(scores) < 1.15
