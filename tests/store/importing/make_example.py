"""Make the example archive that the package ships, from the session that it ships.

Run from the root of the checkout::

    PYTHONPATH=src:. python -m tests.store.importing.make_example

The figures of the session are put into the form of upload dictionaries, which the importer reads as it reads any; what
it keeps of the files themselves is left out. The archive appears in ``src/palpate/data/example_archive``.
"""

from __future__ import annotations

import json
import math
import shutil
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from palpate.store.archive import export_archive
from palpate.store.importing.items import identified
from palpate.store.importing.own_formats import EXAMPLE
from palpate.store.importing.uploads import read_upload
from palpate.store.opening import open_store
from palpate.store.records import Recording

SESSION = EXAMPLE.with_name("banana_session.jsonl")


def made_recordings() -> Iterator[Recording]:
    """The recordings of the example."""
    head, *rows = map(json.loads, SESSION.read_text(encoding="utf-8").splitlines())
    with TemporaryDirectory() as name:
        # in the order of the files' names, as an import of the files has them
        for row in sorted((row for row in rows if "end" not in row), key=lambda row: str(row["name"])):
            yield _recording(head["setup"], row, Path(name))


def _recording(head: Mapping[str, Any], row: Mapping[str, Any], folder: Path) -> Recording:
    file = folder / f"upload_dict_{head['time_in_file_names']}_{row['name']}.json"
    file.write_text(json.dumps({"measurement": _measurement(head, row), "entry": _entry(row["entry"])}))
    recording = read_upload(file)
    return identified(replace(recording, files=()))


def _measurement(head: Mapping[str, Any], row: Mapping[str, Any]) -> dict[str, Any]:
    devices = {key: value for key, value in head.items() if key not in ("object_instance", "time_in_file_names")}
    outputs: dict[str, dict[str, Any]] = {}
    # the files were on another computer, and are not there
    paths = {channel: f"C:\\{text.removesuffix(' (not there)')}" for channel, text in row["files"].items()}
    for full, value in {**row["series"], **paths}.items():
        device, _, channel = full.rpartition(".")
        outputs.setdefault(device, {})[channel] = value
    shared = {"object_instance": head["object_instance"], "setup": devices, "grasp": None}
    return {**shared, "sensor_outputs": outputs, **row["poses"]}


def _entry(entry: Mapping[str, Any]) -> dict[str, Any]:
    """The entry with the NaN for which the session has null."""
    return {**entry, "values": [_value(value) for value in entry["values"]]}


def _value(value: Mapping[str, Any]) -> Mapping[str, Any]:
    return {**value, "mean": math.nan} if "mean" in value and value["mean"] is None else value


def make(folder: Path) -> None:
    """Write the archive into a new folder."""
    with TemporaryDirectory() as name, open_store(Path(name) / "store.sqlite", durable=False) as store:
        store.put_many(made_recordings())
        export_archive(store, folder)


if __name__ == "__main__":
    shutil.rmtree(EXAMPLE, ignore_errors=True)
    make(EXAMPLE)
