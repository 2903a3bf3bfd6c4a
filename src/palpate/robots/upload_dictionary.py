"""Sessions from folders of "upload dictionaries", the files of the paper's measurements.

What the files leave open is decided here by `Conventions`, and every decision is told in the
session: nothing is guessed in silence.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path, PureWindowsPath
from typing import Any

from palpate.errors import LogError, choices
from palpate.network.model import Network
from palpate.outcomes import Outcome
from palpate.robots.session import Recording, Session
from palpate.robots.upload_format import AS_PUBLISHED, FILE_NAME, Conventions, UploadDictionary
from palpate.robots.upload_outcomes import averaged_outcome, classified_outcome, measured_outcome

__all__ = ["AS_PUBLISHED", "Conventions", "convert"]

Signals = Mapping[str, Sequence[float]]


def convert(
    folder: str | Path,
    network: Network,
    *,
    source: str,
    conventions: Conventions = AS_PUBLISHED,
    labels: bool = False,
) -> Session:
    """Read a folder of upload dictionaries of one object.

    Parameters
    ----------
    network
        Its prior splits labels that stand for several states; its actions order the recordings.
    source
        Where the folder is from, for people to read.
    labels
        Take a classifier's most probable label as the outcome and not its probabilities.

    Raises
    ------
    LogError
        No upload dictionary is there, one cannot be read or lacks a key, an entry is of no action
        of the network, or the files are of different objects.
    """
    files = sorted(path for path in Path(folder).glob("*.json") if FILE_NAME.fullmatch(path.name))
    if not files:
        raise LogError(f"{folder}: no file upload_dict_<time>_<entry>_<number>.json was found")
    dictionaries = [UploadDictionary.read(path) for path in files]
    objects = {str(d.at("measurement", "object_instance", "common_name")) for d in dictionaries}
    if len(objects) > 1:
        raise LogError(f"{folder}: recordings of {', '.join(sorted(objects))} were found, expected one object")
    recordings = [_recording(d, network, conventions, labels) for d in dictionaries]
    order = list(network.actions)
    return Session(
        object=objects.pop(),
        source=source,
        setup=_setup(dictionaries[0]),
        decisions=(
            "the files do not tell the order of the recordings: they are in the order of the network's actions",
            "poses are kept as given: their units and the convention of the Euler angles are not stated",
        ),
        recordings=tuple(sorted(recordings, key=lambda recording: order.index(recording.action))),
    )


def _setup(dictionary: UploadDictionary) -> dict[str, Any]:
    """Return the devices, the object as its data set knows it, and the time in the files' names."""
    setup = dictionary.at("measurement", "setup")
    instance = dictionary.at("measurement", "object_instance")
    if not isinstance(setup, Mapping) or not isinstance(instance, Mapping):
        raise LogError(f"{dictionary.file}: measurement.setup and measurement.object_instance must be objects")
    return {**setup, "object_instance": instance, "time_in_file_names": dictionary.time}


def _recording(dictionary: UploadDictionary, network: Network, conventions: Conventions, labels: bool) -> Recording:
    name = str(dictionary.at("entry", "name"))
    action = conventions.actions.get(name, name)
    if action not in network.actions:
        raise LogError(f"{dictionary.file}: entry.name {name!r} is of no action; {choices(network.actions)}")
    series, files = _signals(dictionary)
    channels = {channel.rpartition(".")[2]: channel for channel in series}
    decisions = [f"{channel} {told}" for channel, told in conventions.remarks.items() if channel in channels]
    decisions += [f"the file of {channel}, {file}, is not there" for channel, file in files.items()]
    units = {channels[channel]: unit for channel, unit in conventions.from_series.values() if channel in channels}
    return Recording(
        name=dictionary.name,
        action=action,
        outcome=_outcome(dictionary, network, conventions, labels, series, decisions),
        decisions=tuple(decisions),
        series=series,
        units={channel: units.get(channel) for channel in series},
        poses={key: dictionary.at("measurement", key) for key in ("object_pose", "gripper_pose")},
        entry=dictionary.at("entry"),
        files={channel: f"{file} (not there)" for channel, file in files.items()},
    )


def _outcome(
    dictionary: UploadDictionary,
    network: Network,
    conventions: Conventions,
    labels: bool,
    series: Signals,
    decisions: list[str],
) -> Outcome:
    """Choose what the entry is taken for; the decisions are added to the list."""
    name = str(dictionary.at("entry", "name"))
    if dictionary.at("entry", "type") == "categorical":
        action = network.action(conventions.actions.get(name, name))
        return classified_outcome(dictionary, network, action, conventions, labels, decisions)
    if name not in conventions.from_series:
        return measured_outcome(dictionary, conventions, decisions)
    channel, unit = conventions.from_series[name]
    samples = next((values for key, values in series.items() if key.rpartition(".")[2] == channel), ())
    return averaged_outcome(dictionary, samples, channel, unit, decisions)


def _signals(dictionary: UploadDictionary) -> tuple[dict[str, Sequence[float]], dict[str, str]]:
    """Return the numeric series and the names of the signals' files, by device and channel."""
    series: dict[str, Sequence[float]] = {}
    files: dict[str, str] = {}
    for device, channels in dictionary.at("measurement", "sensor_outputs").items():
        for channel, signal in channels.items():
            if isinstance(signal, str):
                # The folders are another computer's; Windows' rules split both kinds of path.
                files[f"{device}.{channel}"] = PureWindowsPath(signal).name
            else:
                series[f"{device}.{channel}"] = signal
    return series, files
