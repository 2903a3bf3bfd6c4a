"""How much memory and time the process that reads an upload has, where the system can hold a process to it."""

from __future__ import annotations

import sys

__all__ = ["LARGEST_MEMORY_BYTES", "LONGEST_S", "limit_process"]

LARGEST_MEMORY_BYTES = 3 << 30
LONGEST_S = 120


def limit_process() -> None:
    """Hold this process to the limits; where the system has none, whoever started it ends it when its time is over."""
    if sys.platform == "win32":
        return
    import resource

    wanted = [(resource.RLIMIT_CPU, LONGEST_S), (resource.RLIMIT_CORE, 0)]
    if sys.platform != "darwin":
        # macOS refuses it
        wanted.append((resource.RLIMIT_AS, LARGEST_MEMORY_BYTES))
    for kind, wished in wanted:
        _, allowed = resource.getrlimit(kind)
        # more than is allowed already cannot be asked for
        most = wished if allowed == resource.RLIM_INFINITY else min(wished, allowed)
        resource.setrlimit(kind, (most, most))
