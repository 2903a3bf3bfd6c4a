from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.store.errors import StoreError
from palpate.store.importing.bags import read_bag
from palpate.store.importing.bags.clouds import cloud_file
from tests.store.importing.bags.made import header, make, ns, topic_map, write_bag

POINT = np.dtype({"names": ["x", "y", "ring"], "formats": ["<f4", "<f4", "<u2"], "offsets": [0, 4, 10], "itemsize": 16})


def cloud(points: np.ndarray, *, big: bool = False, padding: int = 0, fields: Any = None) -> Any:
    """A message of points (rows, columns)."""
    codes = {"f4": 7, "u2": 4}
    described = [
        make(
            "sensor_msgs/msg/PointField",
            name=name,
            offset=dict(points.dtype.fields or {})[name][1],
            datatype=codes[points.dtype[name].str[1:]],
            count=1,
        )
        for name in points.dtype.names or ()
    ]
    rows, columns = points.shape
    data = b"".join(row.tobytes() + b"\xaa" * padding for row in points)
    return make(
        "sensor_msgs/msg/PointCloud2",
        header=header(ns(0)),
        height=rows,
        width=columns,
        fields=described if fields is None else fields,
        is_bigendian=big,
        point_step=points.dtype.itemsize,
        row_step=columns * points.dtype.itemsize + padding,
        data=np.frombuffer(data, np.uint8),
        is_dense=False,
    )


def some_points(dtype: np.dtype[Any]) -> np.ndarray:
    points = np.zeros((2, 3), dtype)
    points["x"] = np.arange(6).reshape(2, 3) / 4
    points["y"] = np.nan
    points["ring"] = np.arange(6).reshape(2, 3) + 300
    return points


def read_pcd(file: bytes) -> tuple[dict[str, str], np.ndarray]:
    """The header of a binary PCD file and its points, read as its specification says."""
    head, _, data = file.partition(b"DATA binary\n")
    lines = (line.split(" ", 1) for line in head.decode().splitlines() if not line.startswith("#"))
    header = dict(lines)
    kinds = [
        f"<{kind.lower()}{size}" for kind, size in zip(header["TYPE"].split(), header["SIZE"].split(), strict=True)
    ]
    return header, np.frombuffer(data, list(zip(header["FIELDS"].split(), kinds, strict=True)))


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 5])
def test_points_are_kept_with_all_fields(big: bool, padding: int) -> None:
    """Each field of each point is in the file with its type, whatever the order of bytes and the gaps between."""
    points = some_points(POINT.newbyteorder(">") if big else POINT)
    header, found = read_pcd(cloud_file(cloud(points, big=big, padding=padding), "/cloud"))
    assert (header["WIDTH"], header["HEIGHT"], header["POINTS"], header["VERSION"]) == ("3", "2", "6", "0.7")
    for name in ("x", "y", "ring"):
        assert np.array_equal(found[name], points[name].ravel(), equal_nan=name == "y")


def test_clouds_become_files(tmp_path: Path) -> None:
    """A topic of point clouds becomes a folder of PCD files."""
    bag = write_bag(tmp_path / "bag", [("/cloud", ns(0), cloud(some_points(POINT)))])
    (found,) = read_bag(bag, topic_map(tmp_path, '[topics."/cloud"]\nfiles = "clouds"'))
    assert [(item.name, item.media_type) for item in found.files] == [
        ("clouds/000000.pcd", "application/vnd.pointcloud-pcd")
    ]


def test_what_is_no_cloud_is_refused() -> None:
    """Fields that are none, or outside of a point, and points that are not there, are refused."""
    good = cloud(some_points(POINT))
    good.data = good.data[:20]
    with pytest.raises(StoreError, match="/cloud: 20 bytes for 2 rows of 48 bytes"):
        cloud_file(good, "/cloud")
    field = make("sensor_msgs/msg/PointField", name="x", offset=14, datatype=7, count=1)
    with pytest.raises(StoreError, match=r"do not fit a point of 16 bytes"):
        cloud_file(cloud(some_points(POINT), fields=[field]), "/cloud")
    for name, code in (("x y", 7), ("x", 9)):
        field = make("sensor_msgs/msg/PointField", name=name, offset=0, datatype=code, count=1)
        with pytest.raises(StoreError, match="expected a name and 1 to 8"):
            cloud_file(cloud(some_points(POINT), fields=[field]), "/cloud")
    with pytest.raises(StoreError, match="has no fields"):
        cloud_file(cloud(some_points(POINT), fields=[]), "/cloud")
