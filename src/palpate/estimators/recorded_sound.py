"""Sound from a file: samples between -1 and 1 of one channel, whatever the file holds."""

from __future__ import annotations

import struct
import warnings
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from palpate.estimators.signals import SignalError

__all__ = ["one_channel", "read_wav"]


def read_wav(path: str | Path) -> tuple[NDArray[np.float64], int]:
    """Samples, (n), and their rate [Hz].

    Raises
    ------
    SignalError
        If the file is not there, is no sound, or holds no sample.
    """
    from scipy.io import wavfile

    # what SciPy raises where a part of the file is missing or says something else
    broken = (
        OSError,
        ValueError,
        EOFError,
        IndexError,
        TypeError,
        ArithmeticError,
        NameError,
        MemoryError,
        struct.error,
    )
    try:
        with warnings.catch_warnings():
            # parts that hold no sound are of no concern here; a file that ends too soon is
            warnings.simplefilter("ignore", wavfile.WavFileWarning)
            warnings.filterwarnings("error", "Reached EOF", wavfile.WavFileWarning)
            rate_hz, found = wavfile.read(path)
    except (*broken, wavfile.WavFileWarning) as error:
        raise SignalError(f"{path}: cannot be read ({error}), expected a whole WAV file") from None
    return one_channel(found, str(path)), int(rate_hz)


def one_channel(values: NDArray[np.generic], name: str = "samples") -> NDArray[np.float64]:
    """The mean of all channels, whole numbers scaled to -1 to 1.

    Parameters
    ----------
    values
        Samples, (n) or (n, channels); bytes without a sign have their zero at 128, as in WAV files.

    Raises
    ------
    SignalError
        If there is none, or one is not finite.

    Examples
    --------
    >>> one_channel(np.array([128, 255], dtype=np.uint8))
    array([0.       , 0.9921875])
    """
    found = np.asarray(values)
    if found.size == 0 or found.ndim not in (1, 2):
        raise SignalError(
            f"{name}: found samples of shape {found.shape}, expected (n) or (n, channels) and n above zero"
        )
    if found.dtype == np.uint8:
        scaled = (found.astype(np.float64) - 128) / 128
    elif np.issubdtype(found.dtype, np.integer):
        scaled = found / -float(np.iinfo(found.dtype).min)
    else:
        scaled = found.astype(np.float64)
    if not np.all(np.isfinite(scaled)):
        raise SignalError(f"{name}: {np.count_nonzero(~np.isfinite(scaled))} of {scaled.size} samples are not finite")
    mono: NDArray[np.float64] = scaled if scaled.ndim == 1 else scaled.mean(axis=1)
    return mono
