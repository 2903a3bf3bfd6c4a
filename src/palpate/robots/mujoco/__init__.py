"""A robot bench in physics: arm, gripper, camera and microphone, simulated by MuJoCo (extra ``bench``)."""

import os
import sys

if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
    # MuJoCo decides when it is imported; without a screen its default cannot draw.
    os.environ.setdefault("MUJOCO_GL", "egl")
