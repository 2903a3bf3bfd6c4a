"""From the bench's signals to outcomes: which models serve which actions."""

from dataclasses import replace

import numpy as np
import pytest

from palpate.estimators.classifier import Classifier
from palpate.network.admission import admit
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Posterior
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.estimates import SOUNDS, Ears, estimates
from palpate.robots.mujoco.knocking import knock
from palpate.robots.mujoco.reading import bench_object
from palpate.robots.mujoco.signals import SoundSignals


def test_the_shipped_models_serve_what_they_know() -> None:
    """Sound is told for the household, whose materials the classifier knows, and not for another network."""
    assert "mat-sound" in estimates(load_network("household"))
    assert "mat-sound" not in estimates(load_network("pantry"))


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
