import io
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.importing.bags.images import image_file
from tests.store.importing.bags.made import header, make, ns, topic_map, write_bag, write_json

DTYPES = {"8": "u1", "6": "u2"}


def image(data: bytes, encoding: str, rows: int, columns: int, step: int, *, big: bool = False) -> Any:
    array = np.frombuffer(data, np.uint8)
    fields = {"height": rows, "width": columns, "step": step, "encoding": encoding, "is_bigendian": int(big)}
    return make("sensor_msgs/msg/Image", header=header(ns(0)), data=array, **fields)


def pixels(png: bytes) -> Any:
    """What another library reads in a PNG, in steps of the sample's type."""
    bits = png[24]
    found = matplotlib.image.imread(io.BytesIO(png), format="png")
    return np.rint(found * (2**bits - 1)).astype(np.uint16)


@given(st.sampled_from(["mono8", "mono16", "rgb8", "bgr8", "rgba8", "bgra8", "16UC1"]), st.booleans(), st.data())
def test_pixels_are_kept(encoding: str, big: bool, data: st.DataObject) -> None:
    """Each pixel comes out in its colours, whatever the order of bytes and the padding of rows."""
    depth = {"mono": 1, "rgb8": 3, "bgr8": 3, "rgba": 4, "bgra": 4, "16UC": 1}[encoding[:4]]
    dtype = np.dtype("u2" if "16" in encoding else "u1").newbyteorder(">" if big else "<")
    rows, columns, padding = (data.draw(st.integers(low, 4)) for low in (1, 1, 0))
    seed = data.draw(st.integers(0, 1000))
    given = np.random.default_rng(seed).integers(0, np.iinfo(dtype).max, (rows, columns, depth)).astype(dtype)
    line = columns * depth * dtype.itemsize
    padded = b"".join(row.tobytes() + b"\xaa" * padding for row in given)
    ending, png = image_file(image(padded, encoding, rows, columns, line + padding, big=big), "/cam")
    shown = given[..., [2, 1, 0, 3][:depth]] if encoding.startswith("bgr") else given
    assert ending == ".png"
    assert (pixels(png).reshape(rows, columns, -1)[..., :depth] == shown).all()


def test_depth_in_metres_becomes_an_array() -> None:
    """Floating-point pixels are kept to the bit, NaN too, as PNG cannot hold them."""
    depth = np.array([[0.25, np.nan], [np.inf, 1e-30]], np.float32)
    ending, data = image_file(image(depth.tobytes(), "32FC1", 2, 2, 8), "/depth")
    assert ending == ".npy"
    assert np.load(io.BytesIO(data)).tobytes() == depth.tobytes()


@pytest.mark.parametrize(
    ("message", "told"),
    [
        (image(b"1234", "yuv422", 1, 1, 4), "/cam: encoding 'yuv422' is not supported; choose from 'mono8'"),
        (image(b"1234", "rgb8", 2, 2, 6), "4 bytes for 2 rows of 6 bytes"),
        (image(b"1234", "rgb8", 1, 1, 2), "4 bytes for 1 rows of 2 bytes"),
        (image(b"", "mono8", 0, 0, 0), "expected at least one pixel"),
        ({"data": "?"}, r"/cam\.data: .*expected bytes"),
        ({"data": "AAAA"}, "/cam: format .* is not known, expected PNG"),
        ({}, "holds no image"),
    ],
)
def test_what_is_no_image_is_refused(message: Any, told: str) -> None:
    """An encoding that is not supported, and pixels that are not there, are refused."""
    with pytest.raises(StoreError, match=told):
        image_file(message, "/cam")


def test_compressed_images_stay_as_they_are(tmp_path: Path) -> None:
    """The bytes of a JPEG or PNG are the file; every n-th is one, numbered, and its time is in a series."""
    data = [b"\xff\xd8\xff" + bytes([place]) for place in range(5)] + [b"\x89PNG\r\n"]
    messages = [
        (
            "/cam",
            ns(place),
            make(
                "sensor_msgs/msg/CompressedImage",
                header=header(ns(place)),
                format="jpeg",
                data=np.frombuffer(one, np.uint8),
            ),
        )
        for place, one in enumerate(data)
    ]
    bag = write_bag(tmp_path / "bag", messages)
    (every,) = read_bag(bag, topic_map(tmp_path, '[topics."/cam"]\nfiles = "imgs/cam0"'))
    assert [(item.name[-10:], item.media_type, item.data) for item in every.files][-2:] == [
        ("000004.jpg", "image/jpeg", data[4]),
        ("000005.png", "image/png", data[5]),
    ]
    (some,) = read_bag(bag, topic_map(tmp_path, '[topics."/cam"]\nfiles = {folder = "imgs/cam0", every = 2}'))
    assert [item.data for item in some.files] == data[::2]
    (channel,) = some.series[0].channels
    assert (some.series[0].name, channel.name, channel.values.tolist()) == ("imgs/cam0", "file", [0, 1, 2])
    assert channel.time_s is not None
    assert channel.time_s.tolist() == [1.23e-7, 2.000000123, 4.000000123]
    assert "/cam: 3 of 6 messages became files, as the map says" in some.notices


def test_files_can_wait_in_a_folder(tmp_path: Path) -> None:
    """Where a folder is given, files are in it and not in memory, and the recording is the same."""
    grey = image(bytes(range(6)), "mono8", 2, 3, 3)
    bag = write_bag(tmp_path / "bag", [("/cam", ns(0), grey), ("/cam", ns(1), grey)])
    topics = topic_map(tmp_path, '[topics."/cam"]\nfiles = "imgs"')
    (tmp_path / "waiting").mkdir()
    (here,) = read_bag(bag, topics)
    (there,) = read_bag(bag, topics, folder=tmp_path / "waiting")
    assert [item.data for item in there.files] == sorted((tmp_path / "waiting").iterdir())
    assert there.digest == here.digest


def test_images_in_json_are_base64(tmp_path: Path) -> None:
    """The data of an image in JSON are read as its schemas write them."""
    bag = write_json(tmp_path / "bag.mcap", [("/cam", ns(0), {"data": "iVBORw==", "format": "png"})])
    (found,) = read_bag(bag, topic_map(tmp_path, '[topics."/cam"]\nfiles = "imgs"'))
    assert found.files[0].data == b"\x89PNG"
