"""One measurement of a Butler's experiment as a recording; what is missing or odd becomes a notice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from palpate.errors import LogError
from palpate.store.checks import check
from palpate.store.errors import StoreError
from palpate.store.importing.butler_folder import CONTEXT, LOG, RESULT, Logged
from palpate.store.importing.butler_results import entries_of
from palpate.store.importing.butler_signals import files_below, signals_in
from palpate.store.importing.items import identified
from palpate.store.importing.json_text import finite
from palpate.store.importing.measurement_parts import grasp_of, pose_of, series_of, setup_of, thing_of
from palpate.store.importing.upload_format import AS_PUBLISHED, Conventions
from palpate.store.records import Pose, Recording, Setup, ThingRef

__all__ = ["AS_LOGGED", "read_measurement"]

AS_LOGGED = replace(
    AS_PUBLISHED,
    # the index of an upload dictionary was made when that was written
    quantities={name: quantity for name, quantity in AS_PUBLISHED.quantities.items() if name != "time"},
    remarks={**AS_PUBLISHED.remarks, "time": "states no unit: it is kept as a channel, and not as time stamps"},
)
"""The conventions of the paper's setup, for what its Butler logged."""
TRUTH = "ground_truth"


def read_measurement(folder: Path, conventions: Conventions = AS_LOGGED) -> Recording:
    """Read the folder of a measurement; the same folder always gives the same recording, under the same id.

    Raises
    ------
    StoreError
        If the name of the experiment tells no time, the folder holds nothing, or a result is none that a store keeps.
    """
    logged = Logged(folder)
    moment, given = logged.moment(), logged.table(RESULT)
    inner = given.get("measurement")
    measurement = inner if isinstance(inner, dict) else given
    thing, is_truth = _thing(logged, measurement)
    action = conventions.actions.get(logged.action, logged.action)
    recording = Recording(moment, action, thing, _setup(logged, measurement), ground_truth=is_truth)
    recording = _with_places(recording, logged, measurement)
    recording = _with_signals(recording, logged, given, measurement, conventions)
    if not (recording.series or recording.files or recording.log):
        raise StoreError(f"{folder}: holds nothing, expected {RESULT}, {LOG} or files")
    recording = replace(recording, notices=tuple(logged.notices))
    check(recording)
    return identified(recording)


def _with_places(recording: Recording, logged: Logged, measurement: Mapping[str, Any]) -> Recording:
    """The recording with grasp and poses."""
    parts = {key: finite(measurement.get(key)) for key in ("grasp", "gripper_pose", "object_pose")}
    gripper, thing = (_pose(logged, parts, key) for key in ("gripper_pose", "object_pose"))
    return replace(recording, grasp=grasp_of(parts), gripper_pose=gripper, object_pose=thing)


def _with_signals(
    recording: Recording,
    logged: Logged,
    given: Mapping[str, Any],
    measurement: Mapping[str, Any],
    conventions: Conventions,
) -> Recording:
    """The recording with what was sensed, what it results in, and the log."""
    signals, used = signals_in(logged, measurement.get("sensor_outputs"))
    samples = {f"{device}.{name}": values for device in signals for name, values in signals[device].items()}
    source = next((part.get("repository") for part in (given, _table(given, "entry")) if "repository" in part), None)
    return replace(
        recording,
        repository=source if isinstance(source, str) else None,
        series=series_of(samples, conventions, logged.notices),
        files=files_below(logged, used),
        entries=entries_of(logged, given, signals, conventions),
        log=logged.log(),
    )


def _thing(logged: Logged, measurement: Mapping[str, Any]) -> tuple[ThingRef, bool]:
    """The object, and whether its context says that the results are known to be true."""
    context = logged.table(CONTEXT) or _table(measurement, "object_instance")
    # people fill this in: "common name" and "ground-truth" as well as common_name
    given = {key.replace(" ", "_").replace("-", "_"): value for key, value in finite(context).items()}
    is_truth = given.pop(TRUTH) if isinstance(given.get(TRUTH), bool) else False
    if type(given.get("dataset_id")) is int:
        given["dataset_id"] = str(given["dataset_id"])
    if given.get("dataset_id") or given.get("common_name"):
        return thing_of(given, logged.notices), is_truth
    unknown = f"unknown object of {logged.name}"
    logged.notices.append(f"the object is not named: it is kept as {unknown!r}")
    return replace(thing_of({**given, "common_name": unknown}, []), common_name=None), is_truth


def _setup(logged: Logged, measurement: Mapping[str, Any]) -> Setup:
    return setup_of(finite(logged.setup() or _table(measurement, "setup")))


def _pose(logged: Logged, parts: Mapping[str, Any], key: str) -> Pose | None:
    try:
        return pose_of(parts, key, "", logged.notices)
    except LogError as error:
        logged.notices.append(f"{error}: it is kept in {RESULT} alone")
        return None


def _table(given: Mapping[str, Any], key: str) -> Mapping[str, Any]:
    found = given.get(key)
    return found if isinstance(found, dict) else {}
