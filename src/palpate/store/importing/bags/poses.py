"""Poses of messages: PoseStamped, TransformStamped, or a pose in a field."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, member
from palpate.store.importing.bags.topics import PoseFrom
from palpate.store.records import Pose

__all__ = ["pose_in"]

UNIT = 1e-3


def pose_in(message: Any, wanted: PoseFrom, where: str, tell: Callable[[str], None]) -> Pose | None:
    """The pose that a message holds; None, which is told, where its place is none.

    Raises
    ------
    StoreError
        If the message holds no pose.
    """
    held = message if wanted.path is None else wanted.path.of(message)
    if held is MISSING and wanted.path is not None:
        raise StoreError(f"{where}: {wanted.path.complaint(message)}")
    parts = _parts(held)
    if parts is None:
        raise StoreError(f"{where}: holds no pose, expected a message such as geometry_msgs/PoseStamped, or its field")
    place, turn = parts
    stated = member(member(message, "header"), "frame_id")
    frame = wanted.frame or (stated if isinstance(stated, str) else "")
    if not frame:
        tell(f"{where}: names no frame")
    # quaternions of ROS end with what ours begin with
    x, y, z, w = turn
    original = {"position": place, "orientation": turn, "frame_id": stated if isinstance(stated, str) else None}
    if not all(map(math.isfinite, (*place, *turn))):
        tell(f"{where}: the pose has numbers that are not finite: it is not kept")
        return None
    length = math.hypot(*turn)
    if abs(length - 1) > UNIT:
        tell(f"{where}: the rotation is a quaternion of length {length:.4g} and not 1: it is kept as given only")
    quaternion = (w, x, y, z) if abs(length - 1) <= UNIT else None
    return Pose((place[0], place[1], place[2]), quaternion, frame or "unstated", original)


def _parts(held: Any) -> tuple[list[float], list[float]] | None:
    """x y z, and the quaternion x y z w."""
    for _ in range(3):
        for first, second in (("position", "orientation"), ("translation", "rotation")):
            place, turn = member(held, first), member(held, second)
            numbers = [member(place, name) for name in "xyz"] + [member(turn, name) for name in "xyzw"]
            if all(isinstance(number, int | float) for number in numbers):
                return [float(number) for number in numbers[:3]], [float(number) for number in numbers[3:]]
        # PoseStamped has the pose in a field, PoseWithCovarianceStamped in a field of it
        held = member(held, "transform") if member(held, "pose") is MISSING else member(held, "pose")
    return None
