"""Sessions from folders of "upload dictionaries", the files of the paper's measurements.

What the files leave open is decided here by `Conventions`, and every decision is told in the
session: nothing is guessed in silence.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path, PureWindowsPath
from typing import Any

from palpate.errors import LogError, choices, near
from palpate.network.model import Network
from palpate.outcomes import Outcome
from palpate.robots.session import Recording, Session
from palpate.robots.upload_outcomes import averaged_outcome, classified_outcome, measured_outcome
from palpate.store.importing.upload_format import AS_PUBLISHED, Conventions, UploadDictionary, files_in

__all__ = ["AS_PUBLISHED", "Conventions", "convert"]

Signals = Mapping[str, Sequence[float]]


def convert(
    paths: str | Path | Iterable[str | Path],
    network: Network,
    *,
    source: str,
    conventions: Conventions = AS_PUBLISHED,
    labels: bool = False,
) -> Session:
    """Read upload dictionaries of one object.

    Parameters
    ----------
    paths
        Files, folders of such files, or both.
    network
        Its prior splits labels that stand for several states; its actions order the recordings.
    source
        Where the files are from, for people to read.
    labels
        Take a classifier's most probable label as the outcome and not its probabilities.

    Raises
    ------
    LogError
        No upload dictionary is there, one cannot be read, lacks a key or has an odd name, an entry
        is of no action of the network, or the files are of different objects.
    """
    dictionaries = [UploadDictionary.read(path) for path in files_in(paths)]
    objects = {str(d.at("measurement", "object_instance", "common_name")) for d in dictionaries}
    if len(objects) > 1:
        found = f"recordings of {', '.join(sorted(objects))} were found"
        raise LogError(f"{Path(dictionaries[0].file).parent}: {found}, expected one object")
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
    setup, instance = (dictionary.mapping("measurement", key) for key in ("setup", "object_instance"))
    return {**setup, "object_instance": instance, "time_in_file_names": dictionary.time}


def _recording(dictionary: UploadDictionary, network: Network, conventions: Conventions, labels: bool) -> Recording:
    name = str(dictionary.at("entry", "name"))
    action = conventions.actions.get(name, name)
    if action not in network.actions:
        hint = near(action, network.actions)
        raise LogError(f"{dictionary.file}: entry.name {name!r}{hint} is of no action; {choices(network.actions)}")
    series, paths = dictionary.signals()
    # The folders are another computer's; Windows' rules split both kinds of path.
    files = {channel: PureWindowsPath(path).name for channel, path in paths.items()}
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
        entry=dictionary.mapping("entry"),
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
