"""A robot bench in physics: arm, gripper, camera and microphone, simulated by MuJoCo (extra ``bench``)."""

import ctypes
import os
import sys

LIBRARIES = {"libEGL.so.1": "egl", "libOSMesa.so.8": "osmesa", "libOSMesa.so.6": "osmesa", "libOSMesa.so": "osmesa"}


def _headless() -> str:
    """What MuJoCo can draw with where there is no screen; without either it would not even be imported unless told."""
    for library, name in LIBRARIES.items():
        try:
            ctypes.CDLL(library)
        except OSError:
            continue
        return name
    return "disabled"


if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
    # MuJoCo decides when it is imported; without a screen its default cannot draw.
    os.environ.setdefault("MUJOCO_GL", _headless())
