"""What a recording tells of the bench: its devices as they are simulated, and where everything was."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import mujoco
import numpy as np

from palpate.recording.recorder import Recorder, current_recording
from palpate.robots.keeping_signals import keep_signals
from palpate.robots.mujoco.arm import LINKS
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.furniture import CAMERA, IMAGE_SIZE, OVERVIEW
from palpate.robots.mujoco.gripper import FORCE_RANGE_N, NEWTON_PER_AMPERE, PAD_MM, POSITION_STEP_MM, STROKE_MM
from palpate.robots.mujoco.knocking import RATE_HZ
from palpate.robots.mujoco.scene import STEP_S
from palpate.robots.signals import ImageSignals, Signals
from palpate.store.records import Device, Pose, Setup

__all__ = ["bench_setup", "engine", "keep_in_recording"]

MAKER = "palpate"
FRAME = "base"
SCENE = "scene.png"


def engine() -> str:
    """The physics engine and its version."""
    return f"MuJoCo {mujoco.__version__}"


def keep_in_recording(bench: Bench, signals: Signals) -> None:
    """Add the signals of an action that has just ended to its recording, and where gripper and object are."""
    recorder = current_recording()
    keep_signals(recorder, signals)
    if not isinstance(signals, ImageSignals):
        _keep_scene(recorder, bench)
    site, thing = bench.scene.data.site("grasp"), bench.scene.data.joint("object").qpos
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, site.xmat)
    recorder.gripper_pose(_pose(site.xpos, quaternion))
    recorder.object_pose(_pose(thing[:3], thing[3:7]))


def _keep_scene(recorder: Recorder, bench: Bench) -> None:
    """Add a picture of the scene, for people; where nothing can draw, the signals are kept all the same."""
    try:
        recorder.file(SCENE, bench.camera.image(OVERVIEW))
    except BenchError as error:
        recorder.notice(f"without a picture of the scene: {error}")


def bench_setup(bench: Bench) -> Setup:
    """The bench as devices, each marked as simulated, with all parameters of its sensors."""
    noise = asdict(bench.noise)
    return Setup(
        arm=_device("arm", "simulated_gen3", _arm(noise)),
        gripper=_device("gripper", "simulated_2f85", _gripper(noise), {"newton_per_ampere": NEWTON_PER_AMPERE}),
        camera=_device("camera", "simulated_camera", _camera(bench, noise)),
        microphone=_device("microphone", "simulated_microphone", _microphone(noise)),
        other=(_device("other", "simulated_bench", {"engine": engine(), "step_s": STEP_S, "noise": noise}),),
    )


def _device(kind: str, name: str, parameters: dict[str, Any], calibration: dict[str, Any] | None = None) -> Device:
    return Device(kind, name, MAKER, {"simulated": True, **parameters}, calibration or {})


def _arm(noise: dict[str, float]) -> dict[str, Any]:
    joints = [{"name": link.name, "torque_limit_nm": link.torque_nm} for link in LINKS]
    return {"like": "Kinova Gen3", "joints": joints, **_of(noise, "torque")}


def _gripper(noise: dict[str, float]) -> dict[str, Any]:
    told = {"stroke_mm": STROKE_MM, "force_range_n": list(FORCE_RANGE_N), "pad_mm": list(PAD_MM)}
    return {"like": "Robotiq 2F-85", **told, "count_mm": POSITION_STEP_MM, **_of(noise, "force", "position", "width")}


def _camera(bench: Bench, noise: dict[str, float]) -> dict[str, Any]:
    camera, (width, height) = bench.scene.model.camera(CAMERA), IMAGE_SIZE
    return {
        "width_px": width,
        "height_px": height,
        "fovy_deg": float(camera.fovy[0]),
        "position_m": camera.pos.tolist(),
        "quaternion": camera.quat.tolist(),
        **_of(noise, "pixel", "light"),
    }


def _microphone(noise: dict[str, float]) -> dict[str, Any]:
    return {"rate_hz": RATE_HZ, "bits": 16, "gain": "automatic", **_of(noise, "sound")}


def _of(noise: dict[str, float], *begins: str) -> dict[str, float]:
    return {name: value for name, value in noise.items() if name.startswith(begins)}


def _pose(translation: Any, quaternion: Any) -> Pose:
    x, y, z = map(float, translation)
    w, i, j, k = map(float, quaternion)
    return Pose((x, y, z), (w, i, j, k), FRAME)
