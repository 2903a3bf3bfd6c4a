"""Knocking: from a recorded impact to where it begins, how fast it dies away, and features of what it sounds like.

Damping tells materials apart better than pitch, which depends on shape and size (Klatzky, Pai and Krotkov 2000): the
loss angle phi of a partial of frequency f that falls by 60 dB in T60 has tan phi = ln(1000) / (pi f T60).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from palpate.estimators.envelope import FRAME_S, check_dying, until_noise
from palpate.estimators.mel import mel_spectrogram
from palpate.estimators.signals import EstimatorError, SignalError, check_clipping, samples

__all__ = ["FEATURES", "Impact", "check_decay", "decay_time_s", "features", "impact", "loss_tangent"]

LEAST_S = 0.05
ONSET_TIMES = 8.0
"""An impact is so many times as loud as the noise before it."""
LOWEST_HZ = 50.0
SWELL_S = 0.05
"""What takes longer to become loudest is no knock."""
BANDS_HZ = ((100.0, 500.0), (500.0, 1500.0), (1500.0, 4000.0), (4000.0, 8000.0))
MELS = 24
ROUNDS = 6
FEATURES = (
    "centroid_hz_log",
    "spread_octaves",
    "rolloff_hz_log",
    "flatness_log",
    *(f"decay_{low:g}_{high:g}_s_log" for low, high in BANDS_HZ),
    *(f"level_{low:g}_{high:g}" for low, high in BANDS_HZ),
    "loss_tangent_log",
)
"""Names of the numbers that `features` gives."""


@dataclass(frozen=True, eq=False)
class Impact:
    """The sound of one knock.

    Attributes
    ----------
    samples
        From the onset on, (n).
    rate_hz
        Samples per second.
    onset_s
        Where it began in the recording [s].
    noise_rms
        Root mean square of the recording before it; 0 where it begins at once.
    """

    samples: NDArray[np.float64]
    rate_hz: float
    onset_s: float
    noise_rms: float


def impact(recording: ArrayLike, rate_hz: float) -> Impact:
    """Find the knock in a recording.

    Parameters
    ----------
    recording
        Samples between -1 and 1, (n).
    rate_hz
        Samples per second, 8000 or more.

    Raises
    ------
    EstimatorError
        If the rate is too low for what is asked of the sound.
    SignalError
        If the recording is silent, cut off or too short after the onset, swells, or nothing stands out: noise is no
        knock.
    """
    if not (np.isfinite(rate_hz) and rate_hz >= 8000):
        raise EstimatorError(f"rate_hz: found {rate_hz}, expected 8000 or more")
    found = samples("recording", recording, at_least=int(LEAST_S * rate_hz))
    if np.ptp(found) == 0:
        raise SignalError(f"recording: all {found.size} samples are {found[0]:g}: silence")
    check_clipping("recording", found)
    middle = float(found.mean())
    found = found - middle
    frame = int(FRAME_S * rate_hz)
    heard = _audible(found, rate_hz)
    power = np.mean(heard[: heard.size // frame * frame].reshape(-1, frame) ** 2, axis=1)
    loudest = int(np.argmax(power))
    quiet = float(np.quantile(power, 0.1))
    before = float(np.median(power[:loudest])) if loudest > 2 else quiet
    floor = min(before, quiet) if quiet > 0 else 0.0
    if power[loudest] < ONSET_TIMES * max(floor, 1e-15):
        raise SignalError("recording: nothing in it is louder than the rest: noise, and no knock")
    rising = power[: loudest + 1] > max(ONSET_TIMES * before / 2, power[loudest] / 100)
    first = loudest - int(np.argmin(rising[::-1])) + 1 if not rising.all() else 0
    start = first * frame
    if found.size - start < LEAST_S * rate_hz:
        raise SignalError(
            f"recording: it ends {(found.size - start) / rate_hz:.3f} s after the knock, {LEAST_S} s are needed"
        )
    # a knock is cut off at its beginning alone, which is little of the recording
    check_clipping("recording", found[start : start + int(LEAST_S * rate_hz)] + middle)
    if first > 2 and power[loudest] < ONSET_TIMES * np.quantile(power[:first], 0.9):
        raise SignalError("recording: what comes before the loudest is nearly as loud: noise, and no knock")
    if (loudest - first) * FRAME_S > SWELL_S:
        raise SignalError(
            f"recording: it swells for {(loudest - first) * FRAME_S:.2f} s; a knock is loudest at its beginning"
        )
    noise = float(np.sqrt(np.mean(found[: start - frame] ** 2))) if start > 2 * frame else 0.0
    return Impact(found[start:], float(rate_hz), start / rate_hz, noise)


def decay_time_s(sound: ArrayLike, rate_hz: float, *, noise_rms: float = 0.0) -> float:
    """Time in which a sound falls by 60 dB [s], by backward integration (Schroeder 1965) of its first 20 dB or so.

    Parameters
    ----------
    sound
        Samples from the onset on, (n).
    noise_rms
        Of the noise under it, whose power is taken off.

    Returns
    -------
    float
        NaN where it does not fall by 10 dB above the noise.

    Examples
    --------
    >>> seconds = np.arange(8000) / 16000
    >>> ringing = np.sin(2 * np.pi * 1000 * seconds) * 10 ** (-3 * seconds / 0.2)
    >>> round(decay_time_s(ringing, 16000), 3)
    0.2
    """
    power = np.asarray(sound, dtype=np.float64) ** 2
    if noise_rms > 0:
        power = until_noise(power, rate_hz, noise_rms) - noise_rms**2
    found, rest = float("nan"), 0.0
    for _ in range(ROUNDS):
        # what would have come after the end belongs to the integral as well
        energy = np.cumsum(power[::-1])[::-1] + rest
        if energy.size == 0 or energy[0] <= 0:
            return float("nan")
        found = _fall_s(10 * np.log10(np.maximum(energy / energy[0], 1e-12)), rate_hz)
        if not np.isfinite(found):
            break
        last = power[-max(power.size // 10, 1) :].mean()
        rest = max(float(last), 0.0) * rate_hz * found / (2 * np.log(1000.0))
    return found


def _fall_s(level_db: NDArray[np.float64], rate_hz: float) -> float:
    """Time of a fall by 60 dB from the slope between -5 and -25 dB, or -15 dB where it does not fall that far."""
    for depth_db in (25.0, 15.0, 10.0):
        inside = (level_db <= -5.0) & (level_db >= -depth_db)
        inside[int(np.argmax(level_db < -depth_db)) or inside.size :] = False
        if level_db.min() < -depth_db and np.count_nonzero(inside) >= 8:
            slope = float(np.polyfit(np.flatnonzero(inside) / rate_hz, level_db[inside], 1)[0])
            return -60.0 / slope if slope < 0 else float("nan")
    return float("nan")


def loss_tangent(frequency_hz: float, decay_s: float) -> float:
    """tan phi of a partial from its frequency and the time in which it falls by 60 dB.

    Examples
    --------
    >>> round(loss_tangent(1000.0, 0.2), 5)
    0.01099
    """
    return float(np.log(1000.0) / (np.pi * frequency_hz * decay_s))


def check_decay(knock: Impact) -> float:
    """Time in which a knock falls by 60 dB [s]; SignalError if it does not die away, or is held before."""
    check_dying(knock.samples, knock.rate_hz, knock.noise_rms)
    found = _decay(knock, None)
    if not np.isfinite(found):
        raise SignalError("recording: what begins in it does not die away above the noise, as a knock would")
    return found


def features(knock: Impact) -> NDArray[np.float64]:
    """What a knock sounds like: the numbers of `FEATURES`.

    Loudness does not count: the microphone's distance and the strength of the knock are of no interest. Where a band
    holds nothing its decay is that of the whole.

    Raises
    ------
    SignalError
        If the sound does not die away from its beginning on: then it was no knock, or the recording is too short or
        too noisy to tell.
    """
    whole = check_decay(knock)
    spectrum = np.abs(np.fft.rfft(knock.samples * np.hanning(2 * knock.samples.size)[knock.samples.size :])) ** 2
    hertz = np.fft.rfftfreq(knock.samples.size, 1 / knock.rate_hz)
    heard = (hertz >= BANDS_HZ[0][0]) & (hertz < min(BANDS_HZ[-1][1], knock.rate_hz / 2))
    hertz, spectrum = hertz[heard], spectrum[heard] + 1e-20
    share = spectrum / spectrum.sum()
    octaves = np.log2(hertz)
    centre = float(share @ octaves)
    spread = float(np.sqrt(share @ (octaves - centre) ** 2))
    rolloff = float(octaves[int(np.searchsorted(np.cumsum(share), 0.85))])
    mels = mel_spectrogram(knock.samples, knock.rate_hz, bands=MELS).mean(axis=1) + 1e-20
    flatness = float(np.mean(np.log(mels)) - np.log(mels.mean()))
    decays = [_decay(knock, band, otherwise=whole) for band in BANDS_HZ]
    levels = [float(share[(hertz >= low) & (hertz < high)].sum()) for low, high in BANDS_HZ]
    peak = float(hertz[int(np.argmax(spectrum))])
    loss = np.log(loss_tangent(peak, whole))
    return np.array([centre, spread, rolloff, flatness, *np.log(decays), *np.log(np.array(levels) + 1e-4), loss])


def _decay(knock: Impact, band: tuple[float, float] | None, otherwise: float = float("nan")) -> float:
    """Decay time of a band [s]; `otherwise` where it holds nothing that decays."""
    from scipy.signal import butter, sosfiltfilt

    sound, noise = knock.samples, knock.noise_rms
    if band is not None:
        low, high = band[0], min(band[1], 0.45 * knock.rate_hz)
        if low >= high:
            return otherwise
        sound = sosfiltfilt(butter(3, (low, high), "bandpass", fs=knock.rate_hz, output="sos"), sound)
        # of white noise a band holds its share of the width
        noise *= float(np.sqrt((high - low) / (knock.rate_hz / 2)))
    found = decay_time_s(sound, knock.rate_hz, noise_rms=noise)
    return min(max(found, 1e-3), 20.0) if np.isfinite(found) else otherwise


def _audible(found: NDArray[np.float64], rate_hz: float) -> NDArray[np.float64]:
    """Without what is too low to hear: hum of handling, wind and drift rise and fall as well."""
    from scipy.signal import butter, sosfilt

    lowest = butter(2, LOWEST_HZ, "highpass", fs=rate_hz, output="sos")
    heard: NDArray[np.float64] = sosfilt(lowest, found - found[0])
    return heard
