"""All curves of one gripper in a file: as arrays of NumPy, or as a table in Parquet."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import UUID
from zipfile import ZIP_DEFLATED, ZipFile

import numpy as np
from numpy.typing import NDArray

from palpate.errors import choices
from palpate.store.curves import curves_of_gripper
from palpate.store.errors import StoreError
from palpate.store.records import Channel
from palpate.store.store import Store

if TYPE_CHECKING:
    import pyarrow

__all__ = ["check_curve_file", "write_curves"]

AT_ONCE = 2000


@dataclass(frozen=True)
class Curve:
    """A channel, and what it is of."""

    recording: UUID
    series: str
    channel: Channel


def write_curves(store: Store, gripper: str, path: Path, *, action: str | None = None) -> int:
    """Write each channel recorded with a gripper, in the order of recording.

    Parameters
    ----------
    store, gripper, action
        As for `palpate.store.curves.curves_of_gripper`.
    path
        ``.npz``: an array ``<recording>/<series>/<channel>`` for each channel, another one with ``/time_s`` behind it
        for its time stamps, and ``channels``, which tells quantity, unit and rate of each as JSON. ``.parquet``: a row
        for each channel, with its values, flat, and their shape.

    Returns
    -------
    int
        How many channels were written.

    Raises
    ------
    StoreError
        If the ending is another one.
    DamagedError
        If bytes are missing or cannot be read.
    """
    check_curve_file("path", path)
    write = CURVE_FILES[path.suffix.lower()]
    found = curves_of_gripper(store, gripper, action=action)
    return write((Curve(id, series.name, channel) for id, series in found for channel in series.channels), path)


def check_curve_file(where: str, path: Path) -> None:
    """Refuse a path whose ending is none of a file of curves; `where` it was stated stands in the error."""
    if path.suffix.lower() not in CURVE_FILES:
        raise StoreError(f"{where}: {str(path)!r} has no ending of a file of curves; {choices(CURVE_FILES)}")


def _write_arrays(curves: Iterable[Curve], path: Path) -> int:
    told: list[str] = []
    taken: set[str] = set()
    with ZipFile(path, "w", ZIP_DEFLATED) as archive:
        for curve in curves:
            channel = curve.channel
            name = _free(f"{curve.recording}/{curve.series}/{channel.name}", taken)
            _add(archive, name, channel.values)
            about = {"array": name, "quantity": channel.quantity, "unit": channel.unit, "rate_hz": channel.rate_hz}
            if channel.time_s is not None:
                stamps = _free(f"{name}/time_s", taken)
                about["time_s"] = stamps
                _add(archive, stamps, channel.time_s)
            told.append(json.dumps(about))
        _add(archive, "channels", np.array(told, dtype=np.str_))
    return len(told)


def _add(archive: ZipFile, name: str, array: NDArray[Any]) -> None:
    with archive.open(f"{name}.npy", "w", force_zip64=True) as opened:
        np.lib.format.write_array(opened, np.asarray(array), allow_pickle=False)


def _free(name: str, taken: set[str]) -> str:
    """A name that no other array has, as slashes may stand in names too."""
    while name in taken or name == "channels":
        name += "_"
    taken.add(name)
    return name


def _write_table(curves: Iterable[Curve], path: Path) -> int:
    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    columns, count = _columns(), 0
    with ParquetWriter(path, columns, compression="zstd") as writer:
        for rows in _chunks(map(_row, curves)):
            writer.write_table(pa.Table.from_pylist(rows, schema=columns))
            count += len(rows)
    return count


def _columns() -> pyarrow.Schema:
    import pyarrow as pa

    texts = [(name, pa.string()) for name in ("recording", "series", "channel", "quantity", "unit")]
    arrays = [("shape", pa.list_(pa.int64())), ("values", pa.list_(pa.float64())), ("time_s", pa.list_(pa.float64()))]
    return pa.schema([*texts, ("rate_hz", pa.float64()), *arrays])


def _row(curve: Curve) -> dict[str, Any]:
    channel = curve.channel
    return {
        "recording": str(curve.recording),
        "series": curve.series,
        "channel": channel.name,
        "quantity": channel.quantity,
        "unit": channel.unit,
        "rate_hz": channel.rate_hz,
        "shape": list(channel.values.shape),
        "values": np.asarray(channel.values, dtype=np.float64).ravel(),
        "time_s": channel.time_s,
    }


def _chunks(rows: Iterable[dict[str, Any]]) -> Iterator[list[dict[str, Any]]]:
    chunk: list[dict[str, Any]] = []
    for row in rows:
        chunk.append(row)
        if len(chunk) == AT_ONCE:
            yield chunk
            chunk = []
    if chunk:
        yield chunk


CURVE_FILES: Mapping[str, Callable[[Iterable[Curve], Path], int]] = {".npz": _write_arrays, ".parquet": _write_table}
"""Ending to what writes such a file."""
