"""Who does the actions of an exploration."""

from __future__ import annotations

from enum import Enum

__all__ = ["RobotKind"]


class RobotKind(Enum):
    """Who does the actions."""

    SAMPLED = "sampled"
    REPLAY = "replay"
    MUJOCO = "mujoco"
