"""Raw signals of a robot in its recordings: read back as they were, and estimated from once more."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.errors import choices, near
from palpate.outcomes import Outcome
from palpate.recording.errors import RecordingError
from palpate.robots.keeping_signals import ARM, EMPTY, GRIPPER, IMAGE, KNOCK, SOUND
from palpate.robots.signal_files import pixels_of, sound_of
from palpate.robots.signals import (
    GripperSamples,
    HoldSignals,
    ImageSignals,
    Signals,
    SoundSignals,
    SqueezeSignals,
    WeighSignals,
)
from palpate.store.records import Channel, Recording

__all__ = ["estimated_again", "signals_in"]


def signals_in(recording: Recording) -> Signals:
    """The signals that `palpate.robots.keeping_signals.keep_signals` put into a recording, to the last bit.

    Raises
    ------
    RecordingError
        If it holds none in this layout, or a part of them is missing.
    """
    files = {item.name: item.data for item in recording.files}
    series = {one.name: {channel.name: channel for channel in one.channels} for one in recording.series}
    try:
        if IMAGE in files:
            return ImageSignals(pixels_of(_bytes(files[IMAGE])))
        if SOUND in files:
            samples, rate_hz = sound_of(_bytes(files[SOUND]))
            knock = files.get(f"data/{KNOCK}.json")
            impulse = None if knock is None else json.loads(_bytes(knock))["impulse_ns"]
            return SoundSignals(samples, rate_hz, impulse)
        if ARM in series:
            return _weighing(series, recording.grasp or {})
        if GRIPPER in series:
            return _squeeze(series[GRIPPER], recording.grasp or {})
    except KeyError as error:
        raise RecordingError(f"recording {recording.id} of {recording.action}: {error.args[0]!r} is missing") from None
    raise RecordingError(
        f"recording {recording.id} of {recording.action} holds no signals that can be estimated from; expected "
        f"{IMAGE}, {SOUND}, or the series {ARM} or {GRIPPER}"
    )


def estimated_again(recording: Recording, estimates: Mapping[str, Callable[[Any], Outcome]]) -> Outcome:
    """The outcome of a recording's signals, by estimators that may be newer than the recording.

    Parameters
    ----------
    estimates
        Action to what makes an outcome of its signals, as `palpate.robots.mujoco.estimates.estimates` gives them.

    Raises
    ------
    RecordingError
        If there is no estimator for its action, or it holds no signals.
    """
    action = recording.action
    if action not in estimates:
        raise RecordingError(
            f"there is no estimator for action {action!r}{near(action, estimates)}: {choices(estimates)}"
        )
    return estimates[action](signals_in(recording))


def _weighing(series: Mapping[str, Mapping[str, Channel]], grasp: Mapping[str, Any]) -> WeighSignals:
    gripper = _samples(series[GRIPPER]) if GRIPPER in series else None
    holds, others = ([_hold(series, told) for told in grasp[key]] for key in ("holds", "others"))
    first, last = grasp["gap_mm"]
    return WeighSignals(tuple(holds), (first, last), tuple(others), gripper)


def _hold(series: Mapping[str, Mapping[str, Channel]], told: Mapping[str, Any]) -> HoldSignals:
    joint, arm = told["joint"], series[ARM]
    held, empty = arm[f"{joint}_torque"], series[EMPTY][f"{joint}_torque"]
    angle = arm.get(f"{joint}_angle")
    return HoldSignals(
        joint,
        held.values,
        _time(held),
        empty.values,
        _time(empty),
        told["lever_m"],
        told["lever_per_offset"],
        None if angle is None else angle.values,
    )


def _squeeze(gripper: Mapping[str, Channel], grasp: Mapping[str, Any]) -> SqueezeSignals:
    found = _samples(gripper)
    return SqueezeSignals(
        found.time_s,
        found.gap_mm,
        found.force_n,
        found.position_counts,
        grasp["contact_area_mm2"],
        grasp["rest_width_mm"],
        found.current_a,
    )


def _samples(gripper: Mapping[str, Channel]) -> GripperSamples:
    gap, current = gripper["gap"], gripper.get("current")
    return GripperSamples(
        _time(gap),
        gap.values,
        gripper["force"].values,
        gripper["position"].values,
        None if current is None else current.values,
    )


def _time(channel: Channel) -> NDArray[np.float64]:
    if channel.time_s is None:
        raise KeyError(f"time_s of {channel.name}")
    return channel.time_s


def _bytes(data: bytes | Path) -> bytes:
    return data.read_bytes() if isinstance(data, Path) else data
