"""MuJoCo's own viewer: a window in which the bench moves as it does in reality."""

from __future__ import annotations

import os
import sys
from time import monotonic, sleep
from typing import Self

import mujoco
import numpy as np

from palpate.robots.mujoco.camera import HIDDEN
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.furniture import OVERVIEW, PLACE_M
from palpate.robots.mujoco.scene import Scene

__all__ = ["Viewer", "look_as"]


def look_as(free: mujoco.MjvCamera, scene: Scene, camera: str = OVERVIEW) -> None:
    """Place a camera that a mouse can move where a camera of the scene is, about a point near the object."""
    placed = scene.data.camera(camera)
    forward = -placed.xmat.reshape(3, 3)[:, 2]
    distance = float((np.array([*PLACE_M, 0.0]) - placed.xpos) @ forward)
    free.type = mujoco.mjtCamera.mjCAMERA_FREE
    free.lookat[:] = placed.xpos + distance * forward
    free.distance = distance
    free.azimuth = np.degrees(np.arctan2(forward[1], forward[0]))
    free.elevation = np.degrees(np.arcsin(forward[2]))


class Viewer:
    """Shows a scene in a window, as fast as reality; to be closed.

    Whoever closes the window does not end what goes on.

    Raises
    ------
    BenchError
        There is no screen, or no window can be opened.
    """

    def __init__(self, scene: Scene) -> None:
        if sys.platform == "linux" and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
            raise BenchError("the viewer needs a screen, and neither DISPLAY nor WAYLAND_DISPLAY is set; make a video")
        from mujoco import viewer

        try:
            self._window = viewer.launch_passive(scene.model, scene.data, show_left_ui=False, show_right_ui=False)
        except (mujoco.FatalError, RuntimeError) as error:
            raise BenchError(f"the viewer cannot open a window ({error}); on macOS run it by mjpython") from error
        self._window.opt.geomgroup[HIDDEN] = 0
        look_as(self._window.cam, scene)
        self._shown_s, self._due_s = float(scene.data.time), monotonic()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def show(self, scene: Scene) -> None:
        """Show the scene as it is now, when as much time has passed as in the scene."""
        if not self._window.is_running():
            return
        passed_s = float(scene.data.time) - self._shown_s
        self._shown_s = float(scene.data.time)
        # a scene that begins anew begins now
        self._due_s = max(self._due_s + max(passed_s, 0.0), monotonic())
        sleep(max(self._due_s - monotonic(), 0.0))
        self._window.sync()

    def close(self) -> None:
        """Close the window; may be called twice."""
        self._window.close()
