"""Which colour a device has: the same one in every plot, as far as there are enough of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from palpate.server.plots.drawing import COLOURS

__all__ = ["device_colours"]


def device_colours(order: Sequence[str], drawn: Iterable[str]) -> Mapping[str, int]:
    """The colour of each device that is drawn.

    Parameters
    ----------
    order
        All devices, in an order that stays: a device has the colour of its place. Those that are not in it come after
        them, by name.
    drawn
        Those of one plot. Of two whose places have the same colour the later one has the next that is free, if any is.

    Examples
    --------
    >>> order = [f"gripper {number}" for number in range(12)]
    >>> device_colours(order, ["gripper 3", "gripper 1"]), device_colours(order, ["gripper 9", "gripper 1"])
    ({'gripper 1': 1, 'gripper 3': 3}, {'gripper 1': 1, 'gripper 9': 2})
    """
    wanted = set(drawn)
    every = dict.fromkeys([*order, *sorted(wanted)])
    found: dict[str, int] = {}
    for place, name in enumerate(every):
        if name in wanted:
            found[name] = _free(place % COLOURS, found.values())
    return found


def _free(colour: int, taken: Iterable[int]) -> int:
    others = set(taken)
    tried = ((colour + step) % COLOURS for step in range(COLOURS))
    return next((one for one in tried if one not in others), colour)
