"""Knocks: onset, decay and features of sounds that are known, and what is refused."""

import wave
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import wavfile

from palpate.estimators.classifier import Classifier, fit_classifier
from palpate.estimators.mel import from_mel, mel_bands, mel_spectrogram, to_mel
from palpate.estimators.recorded_sound import one_channel, read_wav
from palpate.estimators.signals import EstimatorError, SignalError
from palpate.estimators.sound import FEATURES, check_decay, decay_time_s, features, impact, loss_tangent
from palpate.outcomes import Failed, Posterior

RATE_HZ = 44_100


def knock(
    decay_s: float,
    rng: np.random.Generator,
    *,
    partials_hz: tuple[float, ...] = (800.0, 1900.0, 4100.0),
    noise: float = 1e-3,
    before_s: float = 0.1,
    length_s: float = 0.6,
) -> np.ndarray:
    """Partials that fall by 60 dB in one time, after silence."""
    seconds = np.arange(int(length_s * RATE_HZ)) / RATE_HZ
    levels = 0.3 / 2.0 ** np.arange(len(partials_hz))
    rings = (a * np.sin(2 * np.pi * f * seconds) for a, f in zip(levels, partials_hz, strict=True))
    sound = np.append(np.zeros(int(before_s * RATE_HZ)), sum(rings) * 10 ** (-3 * seconds / decay_s))
    return np.asarray(sound + rng.normal(0, noise, sound.size))


@pytest.mark.parametrize("decay_s", [0.02, 0.05, 0.2, 0.5, 1.5])
def test_onset_and_decay_are_found(decay_s: float) -> None:
    """The onset within 10 ms, the time of a fall by 60 dB within 5 %, noise or none, cut off at the end or not."""
    rng = np.random.default_rng(1)
    for noise in (1e-5, 1e-3):
        found = impact(knock(decay_s, rng, noise=noise), RATE_HZ)
        assert found.onset_s == pytest.approx(0.1, abs=0.01)
        assert decay_time_s(found.samples, RATE_HZ, noise_rms=found.noise_rms) == pytest.approx(decay_s, rel=0.05)


def test_loss_tangent_is_that_of_a_partial() -> None:
    """By hand: a decay rate of alpha = pi f tan(phi) falls by 60 dB when exp(-alpha T) = 1/1000."""
    tangent = 0.01
    decay_s = np.log(1000) / (np.pi * 440 * tangent)
    assert loss_tangent(440, decay_s) == pytest.approx(tangent)


def test_loudness_does_not_count() -> None:
    """A knock twice as loud has the same features."""
    sound = knock(0.2, np.random.default_rng(2))
    once, twice = features(impact(sound, RATE_HZ)), features(impact(2 * sound, RATE_HZ))
    np.testing.assert_allclose(once, twice, atol=1e-6)
    assert once.shape == (len(FEATURES),)


def test_duller_sounds_have_shorter_decays() -> None:
    """Each feature of decay grows with the decay, band by band where there is a partial."""
    rng = np.random.default_rng(3)
    table = np.array([features(impact(knock(decay, rng, noise=1e-5), RATE_HZ)) for decay in (0.03, 0.1, 0.3, 1.0)])
    for name in ("decay_500_1500_s_log", "decay_1500_4000_s_log", "decay_4000_8000_s_log"):
        assert np.all(np.diff(table[:, FEATURES.index(name)]) > 0)
    assert np.all(np.diff(table[:, FEATURES.index("loss_tangent_log")]) < 0)


def coloured_noise(power: float, rng: np.random.Generator, length: int = RATE_HZ // 2) -> np.ndarray:
    """Noise whose power falls with that power of the frequency: white is 0, pink 1, brown 2."""
    hertz = np.fft.rfftfreq(length, 1 / RATE_HZ)
    spectrum = np.fft.rfft(rng.standard_normal(length))
    spectrum[1:] /= hertz[1:] ** (power / 2)
    spectrum[0] = 0
    noise = np.fft.irfft(spectrum, length)
    return np.asarray(0.5 * noise / np.abs(noise).max())


@pytest.mark.parametrize("power", [0.0, 1.0, 2.0])
def test_noise_alone_is_no_knock(power: float) -> None:
    """Noise, white, pink or brown, quiet or loud, gives no features to be sure of."""
    rng = np.random.default_rng(4)
    for _ in range(50):
        with pytest.raises(SignalError):
            features(impact(rng.uniform(0.01, 1) * coloured_noise(power, rng), RATE_HZ))


def test_what_begins_and_stays_is_no_knock() -> None:
    """A tone or noise that is switched on rings for ever, and one that swells is loudest at its end."""
    rng, seconds = np.random.default_rng(5), np.arange(RATE_HZ) / RATE_HZ
    on = np.where(seconds < 0.2, 1e-3, 1.0)
    for lasting in (0.3 * np.sin(2 * np.pi * 700 * seconds), rng.normal(0, 0.1, RATE_HZ)):
        with pytest.raises(SignalError):
            features(impact(on * lasting, RATE_HZ))
    rising = np.interp(seconds, [0.2, 0.3, 1.0], [1e-3, 1.0, 0.3])
    swelling = rising * 0.3 * np.sin(2 * np.pi * 700 * seconds)
    with pytest.raises(SignalError, match="swells"):
        impact(swelling, RATE_HZ)


@given(
    st.sampled_from(["even", "faded", "round"]),
    st.floats(0.02, 0.2),
    st.floats(700, 6000),
    st.booleans(),
    st.integers(0, 2**32 - 1),
)
def test_beeps_and_bursts_of_noise_are_no_knocks(
    shape: str, length_s: float, hertz: float, noisy: bool, seed: int
) -> None:
    """Whatever is held and then ends, at once or faded in and out, is refused, as a tone and as noise."""
    rng, seconds = np.random.default_rng(seed), np.arange(RATE_HZ // 2) / RATE_HZ
    inside = seconds < length_s
    loudness = {
        "even": inside,
        "faded": np.clip(np.minimum(seconds, length_s - seconds) / 0.005, 0, 1),
        "round": np.where(inside, np.sin(np.pi * seconds / length_s) ** 2, 0),
    }[shape]
    wave = rng.normal(0, 0.3, seconds.size) if noisy else np.sin(2 * np.pi * hertz * seconds)
    before = np.zeros(4410 + int(rng.integers(220)))
    beep = np.concatenate([before, 0.4 * loudness * wave])
    with pytest.raises(SignalError):
        features(impact(beep + rng.normal(0, 1e-3, beep.size), RATE_HZ))


@given(
    st.lists(st.tuples(st.floats(100, 8000), st.floats(0.02, 1.0), st.floats(0.1, 1)), min_size=1, max_size=6),
    st.integers(0, 2**32 - 1),
)
def test_partials_that_die_away_are_a_knock(partials: list[tuple[float, float, float]], seed: int) -> None:
    """Whatever their pitches, decays and levels: no knock is taken for a beep."""
    rng, seconds = np.random.default_rng(seed), np.arange(RATE_HZ) / RATE_HZ
    rings = [level * np.sin(2 * np.pi * f * seconds) * 10 ** (-3 * seconds / decay) for f, decay, level in partials]
    sound = np.append(np.zeros(4410), sum(rings) / len(rings))
    check_decay(impact(sound + rng.normal(0, 1e-4, sound.size), RATE_HZ))


@pytest.mark.parametrize("samples", [1, 2, 5])
def test_a_click_is_no_knock(samples: int) -> None:
    """Of what is over at once no decay can be told."""
    click = np.zeros(RATE_HZ // 2)
    click[4410 : 4410 + samples] = 0.5
    with pytest.raises(SignalError):
        features(impact(click + np.random.default_rng(6).normal(0, 1e-3, click.size), RATE_HZ))


@pytest.mark.parametrize(
    ("recording", "told"),
    [
        ([], "0 samples"),
        (np.zeros(22_050), "silence"),
        (np.full(22_050, np.nan), "not finite"),
        (np.sign(np.sin(np.arange(22_050) / 20)), "cut off"),
        (np.append(np.zeros(22_050), np.sin(np.arange(900))), "after the knock"),
    ],
)
def test_bad_recordings_are_refused_with_the_reason(recording: np.ndarray, told: str) -> None:
    """What cannot be a knock is refused, and why."""
    with pytest.raises(SignalError, match=told):
        impact(recording, RATE_HZ)
    with pytest.raises(EstimatorError, match="rate_hz"):
        impact(np.ones(100), 100)


def test_a_knock_that_is_too_loud_is_cut_off() -> None:
    """Cut off at half of its peak or less a knock is refused; a low and whole one, whose crests are flat, is not."""
    loud = knock(1.0, np.random.default_rng(5), partials_hz=(300.0,))
    with pytest.raises(SignalError, match="cut off"):
        impact(np.clip(loud, -0.1, 0.1), RATE_HZ)
    low = np.round(knock(1.0, np.random.default_rng(5), partials_hz=(80.0,), noise=0.0) * 128) / 128
    assert impact(low, RATE_HZ).onset_s == pytest.approx(0.1, abs=0.02)


def test_a_knock_that_is_cut_off_only_at_its_beginning_is_refused() -> None:
    """A short and loud knock soon falls below the limit: little of the recording is cut off, much of its first part."""
    loud = knock(0.2, np.random.default_rng(5), partials_hz=(1200.0,))
    most = 0.5 * np.abs(loud).max()
    with pytest.raises(SignalError, match="cut off"):
        impact(np.append(np.clip(loud, -most, most), np.zeros(RATE_HZ)), RATE_HZ)


def mel_edges(bands: int) -> np.ndarray:
    low, high = to_mel([50.0, RATE_HZ / 2])
    return from_mel(np.linspace(low, high, bands + 2))


@given(st.floats(0, 20_000), st.integers(1, 80), st.sampled_from([256, 1411]))
def test_mel_bands_cover_all_frequencies(hertz: float, bands: int, length: int) -> None:
    """Mel is invertible, no band is empty, and between the first and last centre the weights sum to one."""
    assert from_mel(to_mel(hertz)) == pytest.approx(hertz, abs=1e-6)
    weights = mel_bands(bands, length, float(RATE_HZ))
    assert np.all(weights.sum(axis=1) > 0)
    grid = np.fft.rfftfreq(length, 1 / RATE_HZ)
    edges = mel_edges(bands)
    inside = (grid >= edges[1]) & (grid <= edges[-2])
    assert np.all(weights.sum(axis=0)[inside] >= 1 - 1e-9)


def test_a_tone_is_in_its_band() -> None:
    """The loudest band of a tone is the one that holds it."""
    tone = np.sin(2 * np.pi * 1000 * np.arange(RATE_HZ) / RATE_HZ)
    power = mel_spectrogram(tone, RATE_HZ, bands=40).mean(axis=1)
    edges = mel_edges(40)
    loudest = int(power.argmax())
    assert edges[loudest] < 1000 < edges[loudest + 2]


@pytest.mark.parametrize("kind", [np.uint8, np.int16, np.int32, np.float32])
@pytest.mark.parametrize("channels", [1, 2])
def test_wav_files_of_all_kinds_are_one_sound(tmp_path: Path, kind: type, channels: int) -> None:
    """8, 16 and 32 bits and floats, mono and stereo, at any rate, give the same samples within a step."""
    wanted = 0.5 * np.sin(np.arange(800) / 9)
    if kind is np.float32:
        written = wanted.astype(np.float32)
    elif kind is np.uint8:
        written = np.round(wanted * 127 + 128).astype(np.uint8)
    else:
        written = np.round(wanted * np.iinfo(kind).max).astype(kind)
    wavfile.write(tmp_path / "a.wav", 16_000, written if channels == 1 else np.stack([written, written], axis=1))
    found, rate_hz = read_wav(tmp_path / "a.wav")
    assert rate_hz == 16_000
    np.testing.assert_allclose(found, wanted, atol=0.009 if kind is np.uint8 else 1e-4)


def test_broken_wav_files_are_refused(tmp_path: Path) -> None:
    """No file, an empty one, one without samples, and any beginning of a whole one: one sentence each."""
    with pytest.raises(SignalError, match="cannot be read"):
        read_wav(tmp_path / "none.wav")
    with wave.open(str(tmp_path / "empty.wav"), "wb") as file:
        file.setnchannels(1)
        file.setsampwidth(2)
        file.setframerate(8000)
    with pytest.raises(SignalError):
        read_wav(tmp_path / "empty.wav")
    wavfile.write(tmp_path / "whole.wav", 8000, np.zeros(50, np.int16))
    whole = (tmp_path / "whole.wav").read_bytes()
    for length in range(0, 60):
        (tmp_path / "part.wav").write_bytes(whole[:length])
        with pytest.raises(SignalError):
            read_wav(tmp_path / "part.wav")


@settings(max_examples=60)
@given(st.binary(max_size=200), st.integers(0, 60))
def test_random_bytes_are_no_sound(tmp_path_factory: pytest.TempPathFactory, junk: bytes, place: int) -> None:
    """A WAV file with other bytes in it is read or refused, and never a traceback."""
    path = tmp_path_factory.mktemp("junk") / "a.wav"
    wavfile.write(path, 8000, np.arange(50, dtype=np.int16))
    content = bytearray(path.read_bytes())
    content[place : place + len(junk)] = junk
    path.write_bytes(bytes(content))
    try:
        found, _ = read_wav(path)
    except SignalError:
        return
    assert found.ndim == 1
    assert np.all(np.isfinite(found))


def test_samples_of_no_sound_are_refused() -> None:
    """Nothing, tables of three axes and numbers that are not finite."""
    for values in (np.zeros(0), np.zeros((2, 2, 2)), np.array([np.inf])):
        with pytest.raises(SignalError):
            one_channel(values)


def two_kinds(count: int, seed: int) -> tuple[np.ndarray, list[str]]:
    """Features of knocks on something that rings and on something dull."""
    rng = np.random.default_rng(seed)
    table, labels = [], []
    for number in range(count):
        dull = number % 2 == 0
        partials = tuple(float(f) for f in rng.uniform(300, 6000, 4))
        sound = knock(float(rng.uniform(0.02, 0.06) if dull else rng.uniform(0.2, 0.8)), rng, partials_hz=partials)
        table.append(features(impact(sound, RATE_HZ)))
        labels.append("dull" if dull else "ringing")
    return np.array(table), labels


def test_sounds_are_told_apart_by_their_decay(tmp_path: Path) -> None:
    """A classifier fitted to some knocks is right about others, its probabilities sum to one, and it is kept whole."""
    table, labels = two_kinds(60, 1)
    fitted = replace(fit_classifier(table, labels, FEATURES), temperature=1.5, source="two kinds")
    fitted.save(tmp_path / "sounds.json")
    kept = Classifier.load(tmp_path / "sounds.json")
    assert (kept.temperature, kept.source) == (1.5, "two kinds")
    right = 0
    for row, label in zip(*two_kinds(60, 2), strict=True):
        outcome = kept.outcome(row)
        assert isinstance(outcome, Posterior)
        assert outcome.temperature == 1.5
        assert sum(outcome.probabilities.values()) == pytest.approx(1)
        right += max(outcome.probabilities, key=lambda name: outcome.probabilities[name]) == label
    assert right >= 57


def test_features_of_something_else_fail() -> None:
    """What is far from every label, or could not be told, gives no probabilities."""
    table, labels = two_kinds(40, 3)
    fitted = fit_classifier(table, labels, FEATURES)
    far = fitted.outcome(table[0] + 1000.0)
    unknown = fitted.outcome(np.where(np.arange(table.shape[1]) == 2, np.nan, table[0]))
    assert isinstance(far, Failed)
    assert isinstance(unknown, Failed)
    assert FEATURES[2] in unknown.reason


def test_wrong_tables_are_errors(tmp_path: Path) -> None:
    """Sizes that do not fit, one label only, and files of something else."""
    with pytest.raises(EstimatorError, match="expected \\(2, 1\\)"):
        fit_classifier([[1.0]], ["a", "b"], ["x"])
    with pytest.raises(EstimatorError, match="two at least"):
        fit_classifier([[1.0], [2.0]], ["a", "a"], ["x"])
    fine = '{"features": ["x"], "labels": ["a"], "means": [[1]], "precision": [[1]]'
    for text in (
        "",
        "[]",
        '{"features": ["x"], "labels": ["a"], "means": [[1, 2]], "precision": [[1]]}',
        fine + ', "temperature": 0}',
        fine + ', "temperature": "warm"}',
        fine.replace("[[1]]", "[[NaN]]") + "}",
    ):
        (tmp_path / "other.json").write_text(text)
        with pytest.raises(EstimatorError):
            Classifier.load(tmp_path / "other.json")
