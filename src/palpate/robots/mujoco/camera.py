"""The camera: images of a scene, drawn without a screen."""

from __future__ import annotations

import os
from typing import Self

import mujoco
import numpy as np
from numpy.typing import NDArray

from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.furniture import CAMERA, IMAGE_SIZE
from palpate.robots.mujoco.scene import Scene

__all__ = ["Camera"]

HIDDEN = 4
"""Group of geoms that are there for physics only."""


class Camera:
    """Draws a scene; made on first use, as that takes a third of a second, and to be closed.

    Parameters
    ----------
    size
        Width and height [pixels].
    """

    def __init__(self, scene: Scene, size: tuple[int, int] = IMAGE_SIZE) -> None:
        self._scene = scene
        self._size = size
        self._renderer: mujoco.Renderer | None = None
        self._option = mujoco.MjvOption()
        self._option.geomgroup[HIDDEN] = 0

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def image(self, camera: str = CAMERA) -> NDArray[np.uint8]:
        """What a camera of the scene sees now, (height, width, 3).

        Raises
        ------
        BenchError
            There is no way to draw on this machine.
        """
        renderer = self._made()
        renderer.update_scene(self._scene.data, camera, self._option)
        return np.array(renderer.render())

    def close(self) -> None:
        """Let go of the graphics; may be called twice."""
        if self._renderer is not None:
            self._renderer.close()
            self._renderer = None

    def _made(self) -> mujoco.Renderer:
        if self._renderer is None:
            width, height = self._size
            try:
                self._renderer = mujoco.Renderer(self._scene.model, height, width)
            # each graphics library has errors of its own, down to missing functions
            except (mujoco.FatalError, RuntimeError, ImportError, AttributeError) as error:
                found = "no graphics library was found" if os.environ.get("MUJOCO_GL") == "disabled" else error
                raise BenchError(
                    f"the bench's camera cannot draw here ({found}): install Mesa's EGL or OSMesa (on Debian and "
                    "Ubuntu apt-get install libegl1 or libosmesa6; MUJOCO_GL=egl or osmesa chooses); only actions that "
                    "look, --video and --rerun need it"
                ) from error
        return self._renderer
