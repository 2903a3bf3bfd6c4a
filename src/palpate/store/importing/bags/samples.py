"""Samples of a channel as they come, message by message, in pieces of little more than their own size."""

from __future__ import annotations

from array import array
from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING
from palpate.store.importing.bags.topics import ChannelFrom
from palpate.store.signals import NUMBERS

__all__ = ["Samples"]

PIECE = 2048


class Samples:
    """The samples of one channel.

    Attributes
    ----------
    places
        Which messages of the topic hold a sample.
    """

    def __init__(self, topic: str, channel: ChannelFrom) -> None:
        self.topic, self.channel = topic, channel
        self.places = array("q")
        self._waiting: list[Any] = []
        self._pieces: list[NDArray[Any]] = []
        self._without: Any = None

    def take(self, message: Any, place: int) -> None:
        """Add the sample of a message, where it holds one."""
        value = self.channel.path.of(message)
        if value is MISSING:
            self._without = message
            return
        self.places.append(place)
        self._waiting.append(value)
        if len(self._waiting) == PIECE:
            self._pack()

    def values(self) -> NDArray[Any]:
        """All samples.

        Raises
        ------
        StoreError
            If no message holds one, or they are not numbers, or not as many in each message.
        """
        if self._waiting:
            self._pack()
        if not self._pieces:
            raise StoreError(f"{self._where}: {self.channel.path.complaint(self._without)}")
        shapes = {piece.shape[1:] for piece in self._pieces}
        if len(shapes) > 1:
            raise self._uneven()
        return np.concatenate(_alike(self._pieces))

    def _pack(self) -> None:
        try:
            piece = np.asarray(self._waiting)
            if piece.dtype.kind == "f" and all(type(value) is int for value in self._waiting):
                # small and large ones together become floating-point numbers unless they are told not to
                piece = np.asarray(self._waiting, np.uint64)
        except ValueError:
            raise self._uneven() from None
        except OverflowError:
            raise StoreError(
                f"{self._where}: no type of 64 bits holds all its integers, expected smaller ones"
            ) from None
        if piece.dtype.kind not in NUMBERS:
            found = next((value for value in self._waiting if np.asarray(value).dtype.kind not in NUMBERS), None)
            raise StoreError(f"{self._where}: found {_short(found)}, expected numbers")
        self._pieces.append(piece)
        self._waiting = []

    def _uneven(self) -> StoreError:
        return StoreError(f"{self._where}: not as many numbers in each message, expected as many, or one place in [ ]")

    @property
    def _where(self) -> str:
        return f"{self.topic} {self.channel.path.text}"


def _alike(pieces: list[NDArray[Any]]) -> list[NDArray[Any]]:
    """Pieces of one type; integers stay integers where there is a type for all of them."""
    if {piece.dtype.kind for piece in pieces} == {"i", "u"} and min(int(piece.min()) for piece in pieces) >= 0:
        return [piece.astype(np.uint64) for piece in pieces]
    return pieces


def _short(value: object) -> str:
    text = repr(value)
    return text if len(text) < 60 else f"{text[:57]}..."
