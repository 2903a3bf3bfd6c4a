"""Sessions: what a real robot recorded of an object, in a file that ships, is read and replayed.

The first line of a session file tells the object, the setup, the source and what was decided
about the session as a whole; then comes a line for each recording, and a last one ``{"end": n}``.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from palpate.errors import EvidenceError, LogError, choices, near
from palpate.evidence import format_item, parse_item
from palpate.logfile import SESSION_FORMAT, Line, read_lines, write_line
from palpate.outcomes import Outcome

__all__ = ["Recording", "Session", "read_session", "shipped_session", "write_session"]

SHIPPED: Mapping[str, str] = {"banana_ycb": "banana_session.jsonl"}
"""Object to the file of its session, in ``palpate/data``."""


@dataclass(frozen=True, eq=False)
class Recording:
    """One measurement with its raw numbers.

    Parameters
    ----------
    series
        Channel to its samples.
    units
        Channel to the unit of its samples; None where it is not known.
    poses
        Poses as they were given.
    entry
        What the robot's own software made of the measurement, as it was given.
    files
        Raw signals that were recorded in files of their own, and where they are.
    decisions
        What was decided to get from the recording to the outcome, for people to read.
    """

    name: str
    action: str
    outcome: Outcome
    decisions: tuple[str, ...] = ()
    series: Mapping[str, Sequence[float]] = field(default_factory=dict)
    units: Mapping[str, str | None] = field(default_factory=dict)
    poses: Mapping[str, Any] = field(default_factory=dict)
    entry: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Session:
    """Recordings of one object by one setup."""

    object: str
    source: str
    recordings: tuple[Recording, ...]
    setup: Mapping[str, Any] = field(default_factory=dict)
    decisions: tuple[str, ...] = ()

    @property
    def recorded(self) -> tuple[tuple[str, Outcome], ...]:
        """Actions and outcomes in recorded order: what a replay needs."""
        return tuple((recording.action, recording.outcome) for recording in self.recordings)

    @property
    def all_decisions(self) -> tuple[str, ...]:
        """All decisions, those about a recording with its name in front."""
        of_recordings = (f"{r.name}: {decision}" for r in self.recordings for decision in r.decisions)
        return (*self.decisions, *of_recordings)


def shipped_session(thing: str) -> Session:
    """Read the session of an object that ships with palpate.

    Raises
    ------
    LogError
        No session of the object ships; the message lists the objects of which one does.

    Examples
    --------
    >>> [recording.action for recording in shipped_session("banana_ycb").recordings]
    ['cat-vision', 'mat-vision', 'mat-sound', 'squeezing', 'weighing']
    """
    if thing not in SHIPPED:
        found = f"no recorded session of {thing!r}{near(thing, SHIPPED)} ships"
        raise LogError(f"{found}: {choices(SHIPPED)} or name a session file")
    return read_session(Path(__file__).parents[1] / "data" / SHIPPED[thing])


def read_session(path: str | Path) -> Session:
    """Read a session file.

    Raises
    ------
    LogError
        The file cannot be read or is no complete session; the message names the file and the line.
    """
    header, *lines = read_lines(path, SESSION_FORMAT)
    if not lines or "end" not in lines[-1].record:
        raise LogError(f"{path} is cut off after line {len(lines) + 1}: its last line must be an 'end'")
    if lines[-1].get("end", int) != len(lines) - 1:
        found = f"{len(lines) - 1} recordings were found"
        raise LogError(f"{path}: {found}, expected {lines[-1].record['end']} as its last line says")
    return Session(
        object=header.get("object", str),
        source=header.get("source", str),
        setup=header.get("setup", dict),
        decisions=tuple(header.get("decisions", list)),
        recordings=tuple(_recording(line) for line in lines[:-1]),
    )


def write_session(session: Session, path: str | Path) -> None:
    """Write a session file; it is there as a whole or not at all."""
    target = Path(path)
    unfinished = target.with_name(target.name + ".unfinished")
    with unfinished.open("w", encoding="utf-8") as file:
        about = {"object": session.object, "source": session.source, "setup": session.setup}
        write_line(file, {"format": SESSION_FORMAT, **about, "decisions": session.decisions})
        for recording in session.recordings:
            write_line(file, _record(recording))
        write_line(file, {"end": len(session.recordings)})
    unfinished.replace(target)


def _record(recording: Recording) -> dict[str, Any]:
    return {
        "name": recording.name,
        "outcome": format_item(recording.action, recording.outcome),
        "decisions": recording.decisions,
        "entry": recording.entry,
        "poses": recording.poses,
        "files": recording.files,
        "units": recording.units,
        "series": recording.series,
    }


def _recording(line: Line) -> Recording:
    try:
        action, outcome = parse_item(line.get("outcome", dict))
    except EvidenceError as error:
        raise LogError(f"{line.where}: 'outcome': {error}") from error
    return Recording(
        name=line.get("name", str),
        action=action,
        outcome=outcome,
        decisions=tuple(line.get("decisions", list)),
        series=line.get("series", dict),
        units=line.get("units", dict),
        poses=line.get("poses", dict),
        entry=line.get("entry", dict),
        files=line.get("files", dict),
    )
