"""A robot bench in physics: arm, gripper, camera and microphone, simulated by MuJoCo (extra ``bench``)."""

import ctypes
import os
import sys


def _headless() -> str:
    """What MuJoCo can draw with where there is no screen: EGL, or else OSMesa."""
    try:
        ctypes.CDLL("libEGL.so.1")
    except OSError:
        return "osmesa"
    return "egl"


if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
    # MuJoCo decides when it is imported; without a screen its default cannot draw.
    os.environ.setdefault("MUJOCO_GL", _headless())
