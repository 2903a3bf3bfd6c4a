"""The bench in physics: how well it weighs and squeezes, and how long its actions take.

Masses and stiffnesses are estimated here as simply as can be, so that the figures are the bench's own.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from importlib.util import find_spec
from multiprocessing import get_context
from time import perf_counter, process_time
from typing import Any

import numpy as np
import pytest

import palpate

# asked without importing it: the bench says what MuJoCo draws with before it is imported
if find_spec("mujoco") is None:
    pytest.skip("the bench needs MuJoCo", allow_module_level=True)

from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.estimates import estimates
from palpate.robots.mujoco.knocking import knock
from palpate.robots.mujoco.looking import look
from palpate.robots.mujoco.noise import QUIET, BenchNoise
from palpate.robots.mujoco.objects import BenchObject
from palpate.robots.mujoco.robot import MujocoRobot
from palpate.robots.mujoco.sound import Substance
from palpate.robots.mujoco.squeezing import squeeze
from palpate.robots.mujoco.weighing import weigh
from palpate.robots.signals import ImageSignals, SoundSignals, SqueezeSignals, WeighSignals

Fixture = Any  # pytest-benchmark's fixture
G_M_S2 = 9.80665
WOOD = Substance(750.0, 1.1e10, 0.25, 60.0, 2e-6)
SURE = {"miss_probability": 0.0, "drop_probability": 0.0, "slip_probability": 0.0}


def block(mass_g: float, elasticity_kpa: float) -> BenchObject:
    return BenchObject("block", mass_g, elasticity_kpa, WOOD, (70, 60, 70), 35, 60, (70, 70))


def mass_g(signals: WeighSignals) -> float:
    """Two joints tell mass and offset."""
    rows = [[G_M_S2 * hold.lever_m, G_M_S2 * hold.lever_per_offset] for hold in signals.holds]
    return float(1e3 * np.linalg.solve(rows, [h.torque_nm.mean() - h.empty_torque_nm.mean() for h in signals.holds])[0])


def modulus_kpa(signals: SqueezeSignals) -> float:
    """Slope where force is felt for certain."""
    touched = signals.force_n > max(0.3 * signals.force_n.max(), 0.5)
    slope = -np.polyfit(signals.gap_mm[touched], signals.force_n[touched], 1)[0]
    return float(1e3 * slope * signals.rest_width_mm / signals.contact_area_mm2)


def test_weighing(benchmark: Fixture) -> None:
    """Weighings of 20 g to 1 kg with all noise and grasps off by up to 10 mm."""
    errors = []
    for place, mass in enumerate((20.0, 100.0, 300.0, 1000.0)):
        bench = Bench(block(mass, 100.0), BenchNoise(**SURE), np.random.default_rng(place))
        errors.append([mass_g(weigh(bench)) - mass for _ in range(40)])
    bias, sd = np.abs(np.mean(errors, axis=1)).max(), np.std(errors, axis=1).max()
    benchmark.extra_info.update(what=f"weigh, SD {sd:.1f} g (6), bias {bias:.1f} g (2)", target_s=0.5)
    benchmark.pedantic(weigh, (bench,), rounds=10)
    assert sd < 6
    assert bias < 2


@pytest.mark.parametrize("quiet", [True, False])
def test_squeezing(benchmark: Fixture, quiet: bool) -> None:
    """Squeezes of 5 to 95 kPa: the greatest relative error without noise, the greatest SD with it."""
    found = {}
    for place, kpa in enumerate((5.0, 20.0, 40.0, 60.0, 95.0)):
        bench = Bench(block(100.0, kpa), QUIET if quiet else BenchNoise(**SURE), np.random.default_rng(place))
        found[kpa] = [modulus_kpa(squeeze(bench)) for _ in range(2 if quiet else 40)]
    worst = max(abs(np.mean(values) / kpa - 1) for kpa, values in found.items())
    bias = max(abs(np.mean(values) - kpa) for kpa, values in found.items())
    sd = max(np.std(values) for values in found.values())
    told = f"no noise: error {worst:.1%} (5 %)" if quiet else f"SD {sd:.1f} kPa (5), bias {bias:.1f} kPa"
    benchmark.extra_info.update(what=f"squeeze, {told}", target_s=0.5)
    benchmark.pedantic(squeeze, (bench,), rounds=10)
    assert worst < 0.05 if quiet else sd < 5


@pytest.mark.parametrize(("deed", "target_s"), [(knock, 0.5), (look, 0.15)])
def test_other_deeds(benchmark: Fixture, deed: Callable[[Bench], SoundSignals | ImageSignals], target_s: float) -> None:
    """A knock with its sound; an image of 640 x 480."""
    with Bench(block(100.0, 50.0), BenchNoise(), np.random.default_rng(0)) as bench:
        benchmark.extra_info.update(what=f"{deed.__name__}", target_s=target_s)
        signals = benchmark.pedantic(deed, (bench,), rounds=20, warmup_rounds=1)
    told = signals.samples if isinstance(signals, SoundSignals) else signals.image
    assert np.ptp(told) > 0, "silence, or an image of nothing"


def explore_once(seed: int) -> int:
    """Explore an object with all five actions; how many were taken."""
    network = palpate.load_network("household")
    skills: dict[str, Callable[[Any], palpate.Outcome]] = {
        "mat-sound": lambda signals: palpate.Label("metal" if signals.samples[-2000:].std() > 0.01 else "foam"),
        "mat-vision": lambda signals: palpate.Label("ceramic" if signals.image.mean() > 128 else "wood"),
        "cat-vision": lambda signals: palpate.Label("mug" if signals.image.mean() > 128 else "box"),
        # those that ship take the place of what only fills the time
        **estimates(network),
    }
    name = list(network.objects)[seed % len(network.objects)]
    with MujocoRobot.of(network, name, skills, rng=np.random.default_rng(seed)) as robot:
        never = palpate.GainBelow(-1.0)
        steps = list(palpate.explore(palpate.ExactBelief(network), robot, stopping=never))
    # a camera that cannot draw costs no time
    assert not any("cannot draw" in getattr(step.outcome, "reason", "") for step in steps)
    return sum(step.action is not None for step in steps)


def test_exploration(benchmark: Fixture) -> None:
    """An exploration with all five actions, from setting up the bench to its end."""
    benchmark.extra_info.update(what="exploration of five actions, bench set up", target_s=4.0)
    seeds: Iterator[int] = iter(range(100))
    taken = benchmark.pedantic(explore_once, setup=lambda: ((next(seeds),), {}), rounds=10)
    assert taken == 5


def processor_s(seed: int) -> float:
    """Processor time of an exploration [s]: however many others want the processors, it stays the same."""
    start = process_time()
    assert explore_once(seed) == 5
    return process_time() - start


def test_processes(benchmark: Fixture) -> None:
    """100 explorations in as many processes as there are cores, beside explorations in one."""
    cores = os.cpu_count() or 1
    rates, processor = [], []
    for workers, count in ((1, 30), (cores, 100)):
        with ProcessPoolExecutor(workers, get_context("spawn")) as pool:
            list(pool.map(explore_once, range(2 * workers)))  # everybody has imported everything
            start = perf_counter()
            processor.append(np.mean(list(pool.map(processor_s, range(count)))))
            rates.append(count / (perf_counter() - start))
    faster, dearer = rates[1] / rates[0], processor[1] / processor[0]
    benchmark.extra_info.update(
        what=f"100 explorations, {cores} processes: {faster:.2f} x as fast, CPU each {dearer:.2f} x"
    )
    benchmark.pedantic(explore_once, (1,), rounds=2)
