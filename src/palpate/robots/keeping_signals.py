"""Keeping the raw signals of a robot in its recordings.

Any robot can keep its signals in this layout, and any estimator can then be tried on what was recorded:

- a weighing: series ``arm`` (``<joint>_torque``, ``<joint>_angle``) while the object is held, ``arm_empty`` with the
  empty gripper, ``gripper`` (``gap``, ``force``, ``position``, ``current``); levers and gaps in the grasp;
- a squeeze: series ``gripper``; contact area and rest width in the grasp;
- a knock: the file ``sound.wav``, and the impulse, where it is known, in ``data/knock.json``;
- an image: the file ``image.png``.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.recording.recorder import Recorder
from palpate.robots.signal_files import wav
from palpate.robots.signals import (
    GripperSamples,
    HoldSignals,
    ImageSignals,
    Signals,
    SoundSignals,
    SqueezeSignals,
    WeighSignals,
)
from palpate.store.records import Channel, Series

__all__ = ["ARM", "EMPTY", "GRIPPER", "IMAGE", "KNOCK", "SOUND", "keep_signals"]

ARM, EMPTY, GRIPPER = "arm", "arm_empty", "gripper"
SOUND, IMAGE, KNOCK = "sound.wav", "image.png", "knock"
Samples = NDArray[np.float64]


def keep_signals(recorder: Recorder, signals: Signals) -> None:
    """Add the signals of one action to its recording.

    Parameters
    ----------
    recorder
        Of the measurement that is running, as `palpate.recording.current_recording` gives it.
    """
    match signals:
        case WeighSignals():
            _keep_weighing(recorder, signals)
        case SqueezeSignals():
            recorder.add_series(_gripper_series(signals.gripper))
            recorder.grasp(
                {"contact_area_mm2": signals.contact_area_mm2, "rest_width_mm": signals.rest_width_mm},
            )
        case SoundSignals():
            recorder.file(SOUND, wav(signals.samples, signals.rate_hz))
            if signals.impulse_ns is not None:
                recorder.variable(KNOCK, {"impulse_ns": signals.impulse_ns})
        case ImageSignals():
            recorder.file(IMAGE, signals.image)


def _keep_weighing(recorder: Recorder, signals: WeighSignals) -> None:
    every = (*signals.holds, *signals.others)
    held = [_channel(f"{hold.joint}_torque", "torque", "N*m", hold.torque_nm, hold.time_s) for hold in every]
    turned = [
        _channel(f"{hold.joint}_angle", "angle", "rad", hold.angle_rad, hold.time_s)
        for hold in every
        if hold.angle_rad is not None
    ]
    empty = [
        _channel(f"{hold.joint}_torque", "torque", "N*m", hold.empty_torque_nm, hold.empty_time_s) for hold in every
    ]
    recorder.add_series(Series(ARM, (*held, *turned)))
    recorder.add_series(Series(EMPTY, tuple(empty)))
    if signals.gripper is not None:
        recorder.add_series(_gripper_series(signals.gripper))
    recorder.grasp(
        {
            "holds": [_levers(hold) for hold in signals.holds],
            "others": [_levers(hold) for hold in signals.others],
            "gap_mm": list(signals.gap_mm),
        }
    )


def _levers(hold: HoldSignals) -> dict[str, Any]:
    return {"joint": hold.joint, "lever_m": hold.lever_m, "lever_per_offset": hold.lever_per_offset}


def _gripper_series(samples: GripperSamples) -> Series:
    channels = [
        _channel("gap", "length", "mm", samples.gap_mm, samples.time_s),
        _channel("force", "force", "N", samples.force_n, samples.time_s),
        _channel("position", "count", "1", samples.position_counts, samples.time_s),
    ]
    if samples.current_a is not None:
        channels.append(_channel("current", "current", "A", samples.current_a, samples.time_s))
    return Series(GRIPPER, tuple(channels))


def _channel(name: str, quantity: str, unit: str, values: NDArray[Any], time_s: Samples) -> Channel:
    return Channel(name, quantity, unit, values, _rate_hz(time_s), time_s)


def _rate_hz(time_s: Samples) -> float | None:
    """Samples per second where they are evenly spaced, to a thousandth of the space between them."""
    steps = np.diff(time_s)
    if steps.size == 0 or steps.mean() <= 0 or np.ptp(steps) > 1e-3 * steps.mean():
        return None
    return float(np.round(1 / steps.mean(), 6))
