"""Point clouds of messages as PCD files, with every field as it was."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from palpate.store.errors import StoreError
from palpate.store.importing.bags.fields import MISSING, member
from palpate.store.importing.bags.images import bytes_in

__all__ = ["cloud_file", "is_cloud"]

TYPES = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
LETTERS = {"i": "I", "u": "U", "f": "F"}


def is_cloud(message: Any) -> bool:
    """Whether a message is a ``sensor_msgs/PointCloud2``."""
    return member(message, "point_step") is not MISSING


def cloud_file(message: Any, where: str) -> bytes:
    """A point cloud as a PCD file, version 0.7, binary.

    Raises
    ------
    StoreError
        If its fields are none that PCD has, or it has less data than points.
    """
    names = ("fields", "width", "height", "point_step", "row_step", "is_bigendian")
    fields, columns, rows, step, row_step, is_big = (member(message, name) for name in names)
    data = np.frombuffer(bytes_in(member(message, "data"), f"{where}.data"), np.uint8)
    dtype = _point(fields, int(step), bool(is_big), where)
    line = columns * step
    if row_step < line or len(data) < row_step * rows:
        found = f"{len(data)} bytes for {rows} rows of {row_step} bytes with {columns} points of {step} bytes"
        raise StoreError(f"{where}: {found}, expected as many bytes as the points need")
    lines = np.ascontiguousarray(data[: row_step * rows].reshape(rows, row_step)[:, :line])
    return _header(dtype, columns, rows).encode("ascii") + _packed(lines, dtype).tobytes()


def _point(fields: Any, step: int, is_big: bool, where: str) -> np.dtype[Any]:
    names, formats, offsets = [], [], []
    for field in fields if isinstance(fields, list) else []:
        name, offset, code, count = (member(field, key) for key in ("name", "offset", "datatype", "count"))
        if code not in TYPES or not isinstance(name, str) or not name.isascii() or not name.isidentifier():
            raise StoreError(f"{where}: the field {name!r} has datatype {code!r}, expected a name and 1 to 8")
        names.append(name)
        formats.append((np.dtype(TYPES[code]).newbyteorder(">" if is_big else "<"), (max(1, count),)))
        offsets.append(offset)
    if not names:
        raise StoreError(f"{where}: has no fields, expected such as x, y and z")
    try:
        return np.dtype({"names": names, "formats": formats, "offsets": offsets, "itemsize": step})
    except (TypeError, ValueError) as error:
        raise StoreError(f"{where}: the fields {names} do not fit a point of {step} bytes ({error})") from error


def _packed(lines: NDArray[np.uint8], dtype: np.dtype[Any]) -> NDArray[Any]:
    """Points without gaps between their fields, little-endian."""
    points = lines.reshape(-1).view(dtype)
    parts = {name: dtype[name] for name in dtype.names or ()}
    plain = np.dtype([(name, part.base.newbyteorder("<"), part.shape) for name, part in parts.items()])
    packed = np.empty(len(points), plain)
    for name in parts:
        packed[name] = points[name]
    return packed


def _header(dtype: np.dtype[Any], columns: int, rows: int) -> str:
    parts = [dtype[name] for name in dtype.names or ()]
    lines = [
        "# .PCD v0.7 - Point Cloud Data file format",
        "VERSION 0.7",
        f"FIELDS {' '.join(dtype.names or ())}",
        f"SIZE {' '.join(str(part.base.itemsize) for part in parts)}",
        f"TYPE {' '.join(LETTERS[part.base.kind] for part in parts)}",
        f"COUNT {' '.join(str(part.shape[0]) for part in parts)}",
        f"WIDTH {columns}",
        f"HEIGHT {rows}",
        "VIEWPOINT 0 0 0 1 0 0 0",
        f"POINTS {columns * rows}",
        "DATA binary",
    ]
    return "\n".join(lines) + "\n"
