"""What the bench's sensors give; the records are those of any robot."""

from __future__ import annotations

from palpate.robots.signals import (
    GripperSamples,
    HoldSignals,
    ImageSignals,
    Signals,
    SoundSignals,
    SqueezeSignals,
    WeighSignals,
)

__all__ = ["GripperSamples", "HoldSignals", "ImageSignals", "Signals", "SoundSignals", "SqueezeSignals", "WeighSignals"]
