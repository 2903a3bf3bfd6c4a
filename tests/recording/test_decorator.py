import asyncio
import inspect
import logging
import multiprocessing
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from palpate.outcomes import Reading
from palpate.recording import About, Outcome, Spool, current_recording, record
from palpate.recording.errors import RecordingError
from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.records import Channel, Device, Pose, Recording, Series, Setup, ThingRef

MUG = ThingRef("ycb", "025_mug")


@pytest.fixture
def spool(tmp_path: Path) -> Spool:
    return Spool(tmp_path / "spool", sync=False)


def recorded(spool: Spool) -> list[Recording]:
    return [spool.read(name) for name in spool.waiting()]


def weigh_in_a_process(folder: str) -> None:
    @record("weighing", thing=MUG, spool=Spool(folder, sync=False))
    def weigh() -> Any:
        sys.stdout.write("from a process\n")
        return Outcome.normal("mass", 118.0, unit="g")

    weigh()


def test_all_that_a_measurement_tells_is_kept(spool: Spool) -> None:
    """Series, files, poses, variables, result, output and log are in the recording."""
    setup = Setup(gripper=Device("gripper", "robotiq_2f85"))

    @record("squeezing", setup=setup, thing=MUG, about=About(owner="lab"), keywords=["FORCE", "FORCE!"], spool=spool)
    def squeeze(samples: Sequence[float]) -> Any:
        recorder = current_recording()
        units = {"position": "mm", "current": "A", "time": "ms"}
        recorder.series("gripper", position=samples, current=samples, time=[0, 10, 20], units=units)
        recorder.file("imgs/cam0.png", np.zeros((2, 3, 3), dtype=np.uint8))
        recorder.variable("forces", {"max_N": 3.5})
        recorder.object_pose(Pose((0.0, 0.1, 0.2)))
        recorder.grasp({"width_mm": 40})
        recorder.notice("slipped once")
        sys.stdout.write("FORCE 3.5\n")
        logging.getLogger("robot").warning("careful")
        return Outcome.normal("elasticity", 42.0, sd=10.0, unit="kPa")

    result = squeeze([1.0, 2.0, 3.0])
    (found,) = recorded(spool)
    assert found.entries == (result,) == (Value("elasticity", 42.0, 10.0, "kPa"),)
    assert (found.action, found.thing, found.setup, found.owner) == ("squeezing", MUG, setup, "lab")
    position = found.series[0].channels[0]
    assert (position.unit, position.values.tolist()) == ("mm", [1.0, 2.0, 3.0])
    assert position.time_s is not None
    assert position.time_s.tolist() == [0.0, 0.01, 0.02]
    files = {item.name: item.data.read_bytes() for item in found.files if isinstance(item.data, Path)}
    assert files["imgs/cam0.png"].startswith(b"\x89PNG")
    assert files["data/forces.json"] == b'{"max_N": 3.5}'
    assert (files["log/FORCE.txt"], files["log/FORCE_.txt"]) == (b"FORCE 3.5\n", b"")
    assert found.log.startswith("FORCE 3.5\n")
    assert "WARNING robot: careful" in found.log
    assert found.grasp == {"width_mm": 40}
    assert found.notices == ("slipped once",)


def test_the_signature_stays(spool: Spool) -> None:
    """Name, signature and documentation are the function's, and so is what it returns."""

    @record("weighing", spool=spool)
    def weigh(times: int, *, slowly: bool = False) -> dict[str, int]:
        """Weigh it."""
        return {"times": times}

    assert (weigh.__name__, weigh.__doc__) == ("weigh", "Weigh it.")
    assert list(inspect.signature(weigh).parameters) == ["times", "slowly"]
    assert weigh(3, slowly=True) == {"times": 3}
    assert any("returned {'times': 3} (dict)" in notice for notice in recorded(spool)[0].notices)


def test_a_measurement_that_raises_is_recorded_as_failed(spool: Spool) -> None:
    """The exception is the function's own, and the recording has it, with what came before."""

    @record("squeezing", thing=MUG, spool=spool)
    def squeeze() -> None:
        current_recording().series("gripper", position=[1.0])
        sys.stdout.write("closing\n")
        raise ZeroDivisionError("jammed")

    with pytest.raises(ZeroDivisionError, match=r"^jammed$"):
        squeeze()
    (found,) = recorded(spool)
    assert found.entries == (FailedEntry("ZeroDivisionError: jammed"),)
    assert found.series
    assert found.log.startswith("closing\nTraceback")
    with pytest.raises(RecordingError, match="no recording"):
        current_recording()


def test_ctrl_c_is_recorded_and_goes_on(spool: Spool) -> None:
    """An interruption is recorded as failed and still interrupts."""

    @record("squeezing", spool=spool)
    def squeeze() -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        squeeze()
    assert recorded(spool)[0].entries == (FailedEntry("KeyboardInterrupt"),)


def test_methods_are_recorded(spool: Spool) -> None:
    """A method is recorded, and the object can be told from its arguments."""

    class Scale:
        offset = 1.0

        @record("weighing", thing=lambda self, name: ThingRef("ycb", name), property="mass", spool=spool)
        def weigh(self, name: str) -> Reading:
            return Reading(117.0 + self.offset, unit="g")

    assert Scale().weigh("025_mug") == Reading(118.0, unit="g")
    (found,) = recorded(spool)
    assert (found.thing, found.entries) == (MUG, (Value("mass", 118.0, None, "g"),))


def test_async_functions_are_recorded_apart(spool: Spool) -> None:
    """Coroutines that take turns have recordings of their own."""

    @record("weighing", spool=spool)
    async def weigh(number: int) -> int:
        for _ in range(3):
            sys.stdout.write(f"scale {number}\n")
            await asyncio.sleep(0)
        current_recording().variable("number", number)
        return number

    async def both() -> list[int]:
        return list(await asyncio.gather(weigh(1), weigh(2)))

    assert asyncio.run(both()) == [1, 2]
    assert inspect.iscoroutinefunction(weigh)
    assert sorted(found.log for found in recorded(spool)) == ["scale 1\n" * 3, "scale 2\n" * 3]


def test_nested_measurements_are_two_recordings(spool: Spool) -> None:
    """A measurement inside another is a recording of its own; what comes after it belongs to the outer one."""

    @record("inner", spool=spool)
    def inner() -> None:
        current_recording().variable("which", "inner")

    @record("outer", spool=spool)
    def outer() -> None:
        inner()
        current_recording().variable("which", "outer")

    outer()
    assert sorted((found.action, len(found.files)) for found in recorded(spool)) == [("inner", 1), ("outer", 1)]


def test_many_at_once_are_all_kept(spool: Spool) -> None:
    """Threads and processes that record in the same second lose nothing and mix nothing."""

    @record("weighing", thing=MUG, spool=spool)
    def weigh(number: int) -> Any:
        current_recording().series("scale", load=[float(number)])
        return Outcome.normal("mass", float(number), unit="g")

    threads = [threading.Thread(target=lambda n=n: [weigh(n * 10 + k) for k in range(10)]) for n in range(8)]
    processes = [
        multiprocessing.get_context("spawn").Process(target=weigh_in_a_process, args=(str(spool.folder),))
        for _ in range(2)
    ]
    workers: list[Any] = [*processes, *threads]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    found = recorded(spool)
    values = sorted(entry.value for one in found for entry in one.entries if isinstance(entry, Value))
    assert values == sorted([float(number) for number in range(80)] + [118.0, 118.0])
    assert all(
        one.series[0].channels[0].values[0] == one.entries[0].value
        for one in found
        if one.series and isinstance(one.entries[0], Value)
    )


def test_a_result_that_no_store_keeps_is_failed_and_returned(spool: Spool, caplog: pytest.LogCaptureFixture) -> None:
    """Probabilities that do not sum to one are returned as they are, and kept as a failure with the reason."""
    wrong = Distribution("material", {"glass": 0.4})

    @record("mat-sound", spool=spool)
    def tap() -> Any:
        return wrong

    assert tap() is wrong
    (found,) = recorded(spool)
    assert isinstance(found.entries[0], FailedEntry)
    assert "sum to 0.4" in found.entries[0].reason
    assert "kept as failed" in caplog.text


@pytest.mark.parametrize("returned", [412.0, (412.0, "g"), {"mass": 412.0}, np.float64(412.0)])
def test_what_is_no_result_is_told_at_once(spool: Spool, caplog: pytest.LogCaptureFixture, returned: object) -> None:
    """A bare number is returned as it is, a warning says that it is no result, and the notice holds it."""

    @record("weighing", property="mass", thing=MUG, spool=spool)
    def weigh() -> object:
        return returned

    assert weigh() is returned
    (found,) = recorded(spool)
    (notice,) = found.notices
    assert found.entries == ()
    assert "412.0" in notice
    (warned,) = caplog.messages
    assert warned.startswith(f"weighing: {notice}; expected what Outcome makes")


def test_what_cannot_be_shown_fails_no_measurement(spool: Spool) -> None:
    """What is returned may be large, and its words may be none."""

    class Mute:
        def __repr__(self) -> str:
            raise RuntimeError("no words")

    for returned in (Mute(), "\udc80\0", np.zeros((100, 100)), ["x" * 10_000] * 1000):

        @record("weighing", thing=MUG, spool=spool)
        def weigh(what: object) -> object:
            return what

        assert weigh(returned) is returned
    notices = [notice for found in recorded(spool) for notice in found.notices]
    assert len(notices) == 4
    assert max(map(len, notices)) < 6000
    assert not any("\n" in notice for notice in notices)


def test_nothing_returned_is_nothing_told(spool: Spool, caplog: pytest.LogCaptureFixture) -> None:
    """A measurement that returns None, or a result, is warned of nothing."""

    @record("weighing", thing=MUG, spool=spool)
    def weigh(what: object) -> object:
        return what

    weigh(None)
    weigh(Reading(412.0, unit="g"))
    assert caplog.messages == []


def test_wrong_signals_are_refused_where_they_are_given(spool: Spool) -> None:
    """A unit of the wrong dimension is an error at that line, and the measurement is recorded as failed."""

    @record("weighing", spool=spool)
    def weigh() -> None:
        current_recording().series("scale", mass=[1.0], units={"mass": "kPa"})

    with pytest.raises(StoreError, match="mass"):
        weigh()
    assert isinstance(recorded(spool)[0].entries[0], FailedEntry)


def test_a_wrong_unit_of_what_everybody_knows_is_an_error_at_its_line(spool: Spool) -> None:
    """Neither a series nor a result in a wrong unit gets into the spool, and the measurement can go on."""
    reached = []

    @record("squeezing", spool=spool)
    def squeeze() -> Any:
        recorder = current_recording()
        with pytest.raises(StoreError, match=r"position.unit: unit 'kg' is mass; expected length, as 'm'"):
            recorder.series("gripper", position=[1.0], units={"position": "kg"})
        with pytest.raises(StoreError, match=r"left.unit: unit 'N' is .*; expected current, as 'A'"):
            recorder.series("gripper", left=[1.0], units={"left": "N"}, quantities={"left": "current"})
        with pytest.raises(StoreError, match=r"unit 'g' is mass; expected .*, as 'Pa'"):
            recorder.entry(Value("elasticity", 42.0, unit="g"))
        reached.append(recorder.recording)
        return Outcome.normal("elasticity", 42.0, unit="g")

    squeeze()
    (found,) = recorded(spool)
    assert (reached[0].series, reached[0].entries, found.series) == ((), (), ())
    assert isinstance(found.entries[0], FailedEntry)
    assert "unit 'g' is mass" in found.entries[0].reason


def test_time_stamps_that_go_back_are_refused(spool: Spool) -> None:
    """They are an error at their line, and equal ones are none; channels may have stamps of their own."""

    @record("weighing", spool=spool)
    def weigh() -> None:
        recorder = current_recording()
        wrong = r"series 'scale', channel 'load': time stamp 2 is 0.001 s, after 0.003 s; expected none to go back"
        with pytest.raises(RecordingError, match=wrong):
            recorder.series("scale", load=[1.0, 2.0, 3.0], time=[0, 3, 1], units={"time": "ms"})
        good, bad = (
            Channel(name, name, None, np.zeros(2), None, np.array(times))
            for name, times in (("a", [0, 1.0]), ("b", [3.0, 1]))
        )
        with pytest.raises(RecordingError, match="channel 'b'"):
            recorder.add_series(Series("both", (good, bad)))
        recorder.series("scale", load=[1.0, 2.0, 3.0], time=[0, 3, 3])

    weigh()
    (found,) = recorded(spool)
    assert [series.name for series in found.series] == ["scale"]


def test_names_are_given_once(spool: Spool) -> None:
    """A second file or series of one name is refused; the first one stays."""

    @record("weighing", spool=spool)
    def weigh() -> None:
        recorder = current_recording()
        recorder.file("note.txt", "first")
        recorder.series("scale", load=[1.0])
        with pytest.raises(RecordingError, match=r"second 'note\.txt'"):
            recorder.file("note.txt", "second")
        with pytest.raises(RecordingError, match="second 'scale'"):
            recorder.series("scale", load=[2.0])

    weigh()
    (found,) = recorded(spool)
    assert [item.data.read_text() for item in found.files if isinstance(item.data, Path)] == ["first"]
    assert found.series[0].channels[0].values.tolist() == [1.0]


def test_odd_texts_lose_nothing(spool: Spool) -> None:
    """Halves of surrogate pairs and null characters, in output or in an exception, are kept as escapes."""

    @record("weighing", spool=spool)
    def weigh() -> None:
        current_recording().hear("\udc80 \0\n")
        raise ValueError("\udc80\0")

    with pytest.raises(ValueError, match="\udc80"):
        weigh()
    (found,) = recorded(spool)
    assert isinstance(found.entries[0], FailedEntry)
    assert "\\udc80" in found.log


@pytest.mark.parametrize("arguments", [{"units": {"lod": "g"}}, {"quantities": {"lod": "mass"}}])
def test_a_unit_of_no_channel_is_named(spool: Spool, arguments: dict[str, Any]) -> None:
    """A misspelt channel is refused with the one that was probably meant."""

    @record("weighing", spool=spool)
    def weigh() -> None:
        current_recording().series("scale", load=[1.0], **arguments)

    with pytest.raises(RecordingError, match="did you mean 'load'"):
        weigh()


def test_nothing_can_be_recorded_without_a_disk(tmp_path: Path) -> None:
    """Where nothing can be written the robot does not move."""
    (tmp_path / "file").write_text("in the way")
    moved = []

    @record("weighing", spool=Spool(tmp_path / "file" / "spool"))
    def weigh() -> None:
        moved.append(True)

    with pytest.raises(RecordingError, match="expected a disk"):
        weigh()
    assert not moved


def test_a_recording_that_is_over_takes_nothing(spool: Spool) -> None:
    """A recorder that is used after its measurement says so."""
    kept = []

    @record("weighing", spool=spool)
    def weigh() -> None:
        kept.append(current_recording())

    weigh()
    with pytest.raises(RecordingError, match="is over"):
        kept[0].notice("late")


@pytest.mark.parametrize("decorated", [staticmethod(len), classmethod(print), lambda: (yield)])
def test_what_cannot_be_recorded_is_refused(decorated: Any) -> None:
    """Generators and static methods are refused when they are decorated."""
    with pytest.raises(RecordingError, match="@record"):
        record("weighing")(decorated)


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ({"thing": "mug"}, r"thing: found 'mug', expected a ThingRef, as ThingRef\("),
        ({"spool": "spool"}, r"spool: found 'spool', expected a Spool, as Spool\("),
        ({"action": ""}, "action: "),
        ({"action": None}, "action: "),
    ],
)
def test_what_no_recording_can_have_is_refused_when_decorated(given: dict[str, Any], expected: str) -> None:
    """A name in the place of an object, a folder in that of a spool, and no action, are told before any call."""
    with pytest.raises(RecordingError, match=f"^@record: {expected}"):
        record(**{"action": "weighing", **given})


def test_a_name_is_no_object(spool: Spool) -> None:
    """What a function tells, or the recorder is told, must be an object; the first before the robot moves."""
    moved = []

    @record("weighing", thing=lambda: "mug", spool=spool)  # type: ignore[arg-type, return-value]
    def weigh() -> None:
        moved.append(True)

    with pytest.raises(RecordingError, match="returned 'mug', expected a ThingRef"):
        weigh()

    @record("weighing", spool=spool)
    def weigh_named() -> None:
        current_recording().thing("mug")  # type: ignore[arg-type]

    with pytest.raises(RecordingError, match="thing: found 'mug', expected a ThingRef"):
        weigh_named()
    assert not moved


def test_a_setup_file_is_read_at_the_first_call(tmp_path: Path, spool: Spool) -> None:
    """The devices come from a TOML file; what is wrong in it is told before the robot moves."""
    file = tmp_path / "setup.toml"

    @record("weighing", setup=file, spool=spool)
    def weigh() -> None: ...

    with pytest.raises(RecordingError, match="cannot be read"):
        weigh()
    file.write_text('[gripper]\nname = "2f85"\ncalibrated_on = 2024-05-01\n[[other]]\nname = "scale"\n')
    weigh()
    gripper, other = recorded(spool)[0].setup.devices
    assert (gripper.name, gripper.calibrated_on, other.kind) == ("2f85", "2024-05-01", "other")
