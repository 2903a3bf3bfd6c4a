from dataclasses import replace

import numpy as np
import pytest

from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.knocking import BEFORE_S, RATE_HZ, knock
from palpate.robots.mujoco.noise import QUIET, BenchNoise
from palpate.robots.mujoco.sound import Substance


def test_a_knock_is_felt_and_heard(bench) -> None:
    """The fingertip strikes the object, and after silence comes a sound between -1 and 1 that dies away."""
    with bench() as made:
        found = knock(made)
    start = round(BEFORE_S * RATE_HZ)
    assert found.impulse_ns is not None
    assert found.impulse_ns > 0.01
    assert np.all(found.samples[:start] == 0)
    assert np.abs(found.samples).max() == pytest.approx(0.5, abs=1e-4)
    early, late = (np.abs(part).max() for part in np.array_split(found.samples[start:], [len(found.samples) // 4]))
    assert late < 0.1 * early


def test_metal_rings_longer_than_wood(block) -> None:
    """Of the same shape, steel still sounds when wood has died away."""
    lasting = {}
    for name, substance in (("wood", block().substance), ("metal", Substance(7850.0, 2.0e11, 0.29, 5.0, 3e-8))):
        with Bench(replace(block(), substance=substance), QUIET, np.random.default_rng(0)) as made:
            samples = knock(made).samples
        lasting[name] = np.sqrt(np.mean(samples[round((BEFORE_S + 0.1) * RATE_HZ) :][:2000] ** 2))
    assert lasting["metal"] > 10 * lasting["wood"]


def test_the_microphone_has_its_noise(bench) -> None:
    """Before the knock the recording is noise of the given level."""
    with bench(replace(QUIET, sound_floor=0.02)) as made:
        found = knock(made)
    assert found.samples[:4000].std() == pytest.approx(0.5 * 0.02, rel=0.1)


def test_the_seed_decides_the_sound(bench) -> None:
    """The same seed gives the same samples, another one others."""
    found = []
    for seed in (1, 1, 2):
        with bench(BenchNoise(), seed=seed) as made:
            found.append(knock(made).samples)
    np.testing.assert_array_equal(found[0], found[1])
    assert not np.array_equal(found[0], found[2])
