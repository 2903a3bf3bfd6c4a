import io
import struct
import wave
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.records import Recording
from tests.store.importing.bags.made import header, make, ns, topic_map, types, write_bag

SAMPLES = np.array([[0, 1], [-5, 300], [32767, -32768], [7, 8]], np.int16)
KEYS = "rate_hz = 8000, channels = 2, sample = 'int16'"


def data(piece: bytes) -> Any:
    return make("audio_common_msgs/msg/AudioData", data=np.frombuffer(piece, np.uint8))


def stamped(place: int, samples: np.ndarray, rate: int = 16000) -> Any:
    arrays = {f"{kind}_data": np.array([], kind) for kind in ("float32", "int32", "int16", "int8", "uint8")}
    arrays["int24_data"] = np.array([], np.int32)
    arrays[f"{samples.dtype}_data"] = samples
    info = make("sound_msgs/msg/AudioInfo", format=8, channels=1, rate=rate, chunk=len(samples))
    audio = make("sound_msgs/msg/Audio", audio=make("sound_msgs/msg/AudioData", **arrays), info=info)
    return types.types["sound_msgs/msg/AudioStamped"](header(ns(place)), audio)


def read(folder: Path, messages: list[Any], sound: str) -> Recording:
    bag = write_bag(folder / "bag", [("/audio", ns(place), message) for place, message in enumerate(messages)])
    (found,) = read_bag(bag, topic_map(folder, f'[topics."/audio"]\nsound = {sound}'))
    return found


def test_bytes_become_wav(tmp_path: Path) -> None:
    """Pieces of samples are one WAV file with every sample; where in it each piece begins is a series."""
    found = read(tmp_path, [data(SAMPLES[:3].tobytes()), data(SAMPLES[3:].tobytes())], f"{{file = 'a/s.wav', {KEYS}}}")
    (item,) = found.files
    assert item.name == "a/s.wav"
    with wave.open(io.BytesIO(item.data if isinstance(item.data, bytes) else b"")) as opened:
        assert (opened.getframerate(), opened.getnchannels(), opened.getsampwidth()) == (8000, 2, 2)
        assert opened.readframes(99) == SAMPLES.tobytes()
    (channel,) = found.series[0].channels
    assert (found.series[0].name, channel.name, channel.values.tolist()) == ("a/s.wav", "first_sample", [0, 3])
    assert channel.time_s is not None
    assert channel.time_s.tolist() == [1.23e-7, 1.000000123]


def test_messages_that_tell_their_rate_need_no_map(tmp_path: Path) -> None:
    """Rate, channels and type of the samples are those of the messages where they tell them."""
    found = read(tmp_path, [stamped(0, SAMPLES.ravel()), stamped(1, SAMPLES.ravel())], "'s.wav'")
    assert isinstance(found.files[0].data, bytes)
    with wave.open(io.BytesIO(found.files[0].data)) as opened:
        assert (opened.getframerate(), opened.getnchannels()) == (16000, 1)
        assert opened.readframes(99) == SAMPLES.tobytes() * 2


def test_floating_point_samples_are_kept(tmp_path: Path) -> None:
    """Samples of 32-bit floating point are format 3 of WAV, to the bit."""
    samples = np.array([0.5, -1.25], np.float32)
    found = read(tmp_path, [stamped(0, samples)], "'s.wav'")
    assert isinstance(found.files[0].data, bytes)
    kind, channels, rate, per_second, frame, bits = struct.unpack_from("<HHIIHH", found.files[0].data, 20)
    assert (kind, channels, rate, per_second, frame, bits) == (3, 1, 16000, 64000, 4, 32)
    assert found.files[0].data.endswith(samples.tobytes())


def test_encoded_pieces_stay_as_they_are(tmp_path: Path) -> None:
    """A file of another ending than .wav holds the very bytes of the messages."""
    inner = [data(b"\xff\xfbone"), data(b"two")]
    messages = [
        make("audio_common_msgs/msg/AudioDataStamped", header=header(ns(place)), audio=one)
        for place, one in enumerate(inner)
    ]
    found = read(tmp_path, messages, "'audio/scratch.mp3'")
    assert (found.files[0].media_type, found.files[0].data) == ("audio/mpeg", b"\xff\xfbonetwo")
    assert found.series[0].channels[0].values.tolist() == [0, 5]


@pytest.mark.parametrize(
    ("messages", "sound", "told"),
    [
        ([data(b"12")], "'s.wav'", "/audio: its messages do not tell rate_hz, expected it in the map"),
        ([data(b"12345")], f"{{file = 's.wav', {KEYS}}}", "5 bytes for samples of 4 bytes at 8000 Hz"),
        ([stamped(0, SAMPLES.ravel()), stamped(1, SAMPLES.ravel(), 8000)], "'s.wav'", "rate_hz is 8000 in a message"),
        ([stamped(0, SAMPLES.ravel())], "{file = 's.wav', channels = 2}", "channels is 1 in a message and 2 before"),
        ([stamped(0, np.array([1], np.int8))], "'s.wav'", "samples in int8_data, which is not supported"),
        ([make("std_msgs/msg/Header", stamp=header(0).stamp, frame_id="")], "'s.wav'", "holds no sound"),
    ],
)
def test_what_is_no_sound_is_refused(tmp_path: Path, messages: list[Any], sound: str, told: str) -> None:
    """What nobody tells, and what does not fit together, is refused."""
    with pytest.raises(StoreError, match=told):
        read(tmp_path, messages, sound)
