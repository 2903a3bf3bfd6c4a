"""Lines of a log from messages: of rosout, or any text."""

from __future__ import annotations

from typing import Any

from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import member

__all__ = ["log_line"]

LEVELS = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL"}
LEVELS |= {1: "DEBUG", 2: "INFO", 4: "WARN", 8: "ERROR", 16: "FATAL"}
"""Levels of messages in ROS 2, and in ROS 1."""


def log_line(message: Any, where: str) -> str:
    """The line that a ``rcl_interfaces/Log``, ``rosgraph_msgs/Log`` or ``std_msgs/String`` is in a log.

    Examples
    --------
    >>> log_line({"level": 30, "name": "gripper", "msg": "slipped"}, "/rosout")
    'WARN gripper: slipped'
    """
    text, name, level = (member(message, field) for field in ("msg", "name", "level"))
    if isinstance(text, str):
        return f"{LEVELS.get(level, level)} {name}: {text}"
    data = member(message, "data")
    if isinstance(data, str):
        return data
    raise StoreError(
        f"{where}: holds no line of a log, expected a message such as rcl_interfaces/Log or std_msgs/String"
    )
