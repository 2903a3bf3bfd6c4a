"""Recordings by grippers that do not exist: each with a noise and a fault of its own, so that they can be compared."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from datetime import UTC, datetime, timedelta
from uuid import NAMESPACE_URL, uuid5

import numpy as np

from palpate.estimators.squeezing import Jaws, squeeze
from palpate.network.model import KnownObject, Network
from palpate.outcomes import Above, Failed, Reading
from palpate.server.security.accounts import EXAMPLE
from palpate.store.entries import Bound, Entry, FailedEntry, Value
from palpate.store.records import Channel, Device, Recording, Series, Setup, ThingRef

__all__ = ["DATASET", "OWNER", "simulated", "true_value"]

DATASET = "simulated"
OWNER = EXAMPLE
NOTICE = "simulated by a program from a spring and noise: nothing was measured"
FIRST = datetime(2025, 1, 1, 9, tzinfo=UTC)
SEED = 20250101


@dataclass(frozen=True)
class Gripper:
    """A gripper that does not exist: noise of force and gap, a factor by which its force is wrong, and bias in mass."""

    name: str
    force_sd_n: float
    gap_step_mm: float
    force_factor: float
    mass_sd_g: float
    mass_bias_g: float
    calibrated_on: str

    @property
    def setup(self) -> Setup:
        """It alone."""
        parameters = {"simulated": True, "contact_area_mm2": AREA_MM2, "gap_step_mm": self.gap_step_mm}
        device = Device("gripper", self.name, "nobody: it is simulated", parameters, {}, self.calibrated_on)
        return Setup(gripper=device)


AREA_MM2 = 1200.0
GRIPPERS = (
    Gripper("simulated two-finger", 0.15, 0.37, 1.00, 5.0, 0.5, "2024-12-01"),
    Gripper("simulated soft fingers", 0.40, 0.05, 0.85, 9.0, -6.0, "2024-11-12"),
    Gripper("simulated three-finger", 0.25, 0.10, 1.08, 3.0, 2.0, "2024-12-20"),
    Gripper("simulated parallel, worn", 0.60, 0.20, 1.22, 6.0, 9.0, "2023-02-03"),
)


def simulated(network: Network, count: int) -> Iterator[Recording]:
    """Recordings of the network's objects by several grippers, the same ones each time."""
    rng = np.random.default_rng(SEED)
    things = [one for one in network.objects.values() if isinstance(true_value(one, "elasticity"), float)]
    for number in range(count):
        gripper, thing = GRIPPERS[number % len(GRIPPERS)], things[number // len(GRIPPERS) % len(things)]
        at = FIRST + timedelta(minutes=7 * number)
        made = (_weighed if number % 5 == 4 else _squeezed)(thing, gripper, rng)
        series, entries, action = made
        recording = Recording(
            recorded_at=at,
            action=action,
            thing=ThingRef(DATASET, thing.name, common_name=thing.name.replace("_", " ")),
            setup=gripper.setup,
            owner=OWNER,
            licence="CC0-1.0",
            visibility="public",
            software="palpate.server.example",
            series=(series,),
            entries=entries,
            notices=(NOTICE,),
        )
        yield replace(recording, id=uuid5(NAMESPACE_URL, f"palpate-example:{number}"))


def true_value(thing: KnownObject, name: str) -> float | str | None:
    """What is known of an object; None where it is not."""
    found = thing.truth.get(name)
    if found is None or isinstance(found.value, str):
        return None if found is None else found.value
    return float(found.value)


def _squeezed(thing: KnownObject, gripper: Gripper, rng: np.random.Generator) -> tuple[Series, tuple[Entry, ...], str]:
    """A spring between two jaws, its force read wrongly by the gripper's factor."""
    width_mm = 30.0 + 40.0 * (sum(thing.name.encode()) % 97) / 97
    elasticity = float(true_value(thing, "elasticity") or 0.0)
    stiffness = elasticity * 1e-3 * AREA_MM2 / width_mm * rng.normal(1.0, 0.05) * gripper.force_factor
    gap = np.linspace(width_mm + 6, width_mm - min(8.0, 40.0 / max(stiffness, 1.0)), 120)
    force = stiffness * np.maximum(0.0, width_mm - gap) + rng.normal(0, gripper.force_sd_n, gap.size)
    read = np.round(gap / gripper.gap_step_mm) * gripper.gap_step_mm
    jaws = Jaws(AREA_MM2, width_mm, gap_sd_mm=gripper.gap_step_mm / 12**0.5)
    found = squeeze(read, force, jaws).outcome
    channels = (
        Channel("position", "length", "mm", np.asarray(read, np.float32), rate_hz=100.0),
        Channel("force", "force", "N", np.asarray(force, np.float32), rate_hz=100.0),
    )
    return Series(gripper.name, channels), (_entry(found),), "squeezing"


def _entry(found: Reading | Above | Failed) -> Entry:
    if isinstance(found, Reading):
        return Value("elasticity", float(found.value), None if found.sd is None else float(found.sd), "kPa")
    if isinstance(found, Above):
        return Bound("elasticity", above=float(found.bound), unit="kPa")
    return FailedEntry(found.reason, "elasticity")


def _weighed(thing: KnownObject, gripper: Gripper, rng: np.random.Generator) -> tuple[Series, tuple[Entry, ...], str]:
    """A mass in noise, off by the gripper's bias."""
    mass_g = float(true_value(thing, "mass") or 0.0)
    samples = rng.normal(mass_g + gripper.mass_bias_g + rng.normal(0, 2.0), gripper.mass_sd_g, 60)
    sd = float(samples.std(ddof=1) / samples.size**0.5)
    channel = Channel("load", "mass", "g", np.asarray(samples, np.float32), rate_hz=50.0)
    return Series(gripper.name, (channel,)), (Value("mass", float(samples.mean()), sd, "g"),), "weighing"
