import math
import os
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.errors import PalpateError
from palpate.store.checks import check
from palpate.store.content import file_digest
from palpate.store.entries import Distribution, Entry, FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.importing.butler import ButlerExperiments
from palpate.store.importing.butler_measurement import read_measurement
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.records import Device, Recording
from palpate.store.store import Store
from palpate.store.verifying import verify
from tests.store.importing.experiments import CONTEXT, RESULT, SETUP, SQUEEZE, experiment, measurement, write


def told(recording: Recording, part: str) -> bool:
    return any(part in notice for notice in recording.notices)


def test_a_measurement_is_read(tmp_path: Path) -> None:
    """Object, devices, grasp, poses, series, files, log and result are where they belong."""
    found = read_measurement(measurement(experiment(tmp_path)))
    assert found.action == "squeezing"
    assert (found.thing.dataset, found.thing.id, found.thing.common_name, found.thing.maker) == (
        "pots",
        "07",
        "teapot",
        "potter",
    )
    assert found.thing.attributes == {"colour": "blue"}
    assert found.setup.devices == (
        Device("arm", "tentacle", "somebody", {"joints": 6}),
        Device("gripper", "claw"),
        Device("other", "bright", parameters={"kind": "lamp"}),
    )
    assert found.recorded_at.isoformat() == "2001-02-03T04:05:06+00:00"
    assert found.entries == (Value("elasticity", 42.0, 4.5, "kPa"),)
    assert (found.grasp, found.repository, found.log) == (
        {"width_mm": 30},
        "https://example.org/squeeze",
        "closing\n",
    )
    assert found.gripper_pose is not None
    assert found.gripper_pose.translation_m == (0.1, 0.2, 0.3)
    ((name, channels),) = [(series.name, series.channels) for series in found.series]
    assert (name, {one.name: one.values.tolist() for one in channels}) == ("claw", SQUEEZE["claw"])
    assert [item.name for item in found.files] == [
        "data/measurement.json",
        "data/object_context.json",
        "figs/curve.png",
        "imgs/cam0.png",
    ]
    for part in ("UTC is assumed", "metres are assumed", "time states no unit"):
        assert told(found, part)


def test_a_tree_is_imported_and_found_again(local: Store, tmp_path: Path) -> None:
    """Two measurements with the same content are two; strange files are skipped; the second run finds all there."""
    folder = experiment(tmp_path)
    for name in ("elasticity_0", "elasticity_1", "mat-sound_0"):
        measurement(folder, name=name)
    write(folder / "notes.txt", "hello")
    (folder / "plots").mkdir()
    (folder / "again_0").symlink_to(folder / "elasticity_0")
    first, again = (list(import_paths(local, [tmp_path / folder.name], all_formats())) for _ in "ab")
    assert [(Path(one.source).name, one.fate) for one in first if one.fate is Fate.SKIPPED] == [
        ("again_0", Fate.SKIPPED),
        ("notes.txt", Fate.SKIPPED),
        ("plots", Fate.SKIPPED),
    ]
    assert [one.fate for one in first].count(Fate.NEW) == [one.fate for one in again].count(Fate.KNOWN) == 3
    assert ButlerExperiments().count(folder) == len(first)
    assert list(verify(local)) == []


def test_the_place_of_a_tree_does_not_matter(tmp_path: Path) -> None:
    """The same tree elsewhere gives the same recordings, odd as it may be."""
    odd = {"data/object_context.json": "{", "data/measurement.json": {"sensor_outputs": {"eye": {"img": "/x/y.png"}}}}
    one, other = (
        read_measurement(measurement(experiment(tmp_path / place, setup="["), odd)) for place in ("here", "there")
    )
    assert (one.digest, one.id) == (other.digest, other.id)
    assert not told(one, str(tmp_path))


@pytest.mark.parametrize(
    ("missing", "notice"),
    [
        ("data/measurement.json", "data/measurement.json is missing"),
        ("data/object_context.json", "data/object_context.json is missing"),
        ("log.txt", ""),
        ("data/forces.json", ""),
    ],
)
def test_a_missing_file_is_noticed(tmp_path: Path, missing: str, notice: str) -> None:
    """A measurement without one of its files is a recording that says so."""
    found = read_measurement(measurement(experiment(tmp_path), {missing: None}))
    assert told(found, notice)
    check(found)


def test_nothing_is_no_recording(tmp_path: Path) -> None:
    """An empty folder, and an experiment whose name tells no time, are refused with the reason."""
    (experiment(tmp_path) / "empty_0").mkdir()
    with pytest.raises(StoreError, match=r"empty_0: holds nothing, expected data/measurement\.json"):
        read_measurement(tmp_path / "experiment_2001_02_03_04_05_06" / "empty_0")
    with pytest.raises(StoreError, match="the time in the name 'experiment_today' cannot be read"):
        read_measurement(measurement(experiment(tmp_path, time="today")))


def test_an_object_without_a_name_is_kept(tmp_path: Path) -> None:
    """Raw signals of an object that nobody named are kept under the measurement's own name."""
    found = read_measurement(measurement(experiment(tmp_path), {"data/object_context.json": {"dataset": "pots"}}))
    assert found.thing.dataset == "pots"
    assert found.thing.id == "unknown object of experiment_2001_02_03_04_05_06/elasticity_0"
    assert told(found, "the object is not named")


def test_words_of_people_are_understood(tmp_path: Path) -> None:
    """A context with other spellings, a number as id, and the truth as a flag."""
    context = {"dataset": "pots", "dataset id": 7, "common name": "teapot", "ground-truth": True}
    found = read_measurement(measurement(experiment(tmp_path), {"data/object_context.json": context}))
    assert (found.thing.id, found.thing.common_name, found.ground_truth) == ("7", "teapot", True)
    known = {**CONTEXT, "ground_truth": {"mass": 66}}
    found = read_measurement(measurement(experiment(tmp_path / "b"), {"data/object_context.json": known}))
    assert (found.ground_truth, found.thing.attributes["ground_truth"]) == (False, {"mass": 66})


@pytest.mark.parametrize(
    ("result", "entries", "notice"),
    [
        ({"meas_prop": "mass", "values": [{"mean": 3, "std": 1, "unit": "g"}]}, [Value("mass", 3.0, 1.0, "g")], ""),
        ({"meas_prop": "mass", "values": 3.5, "units": "g"}, [Value("mass", 3.5, None, "g")], ""),
        ({"property": "mass", "mean": 3.5, "params": None}, [Value("mass", 3.5)], "mass has no unit"),
        (
            {"meas_prop": "cat-vision", "meas_type": "categorical", "params": {"mug": 0.75, "pot": 0.25}},
            [Distribution("category", {"mug": 0.75, "pot": 0.25})],
            "",
        ),
        (
            {"meas_prop": "kind", "params": {"mug": 0.75, "pot": 0.25}},
            [Distribution("kind", {"mug": 0.75, "pot": 0.25})],
            "",
        ),
        ({"meas_prop": "size", "params": {"a": 1.0, "b": 2.0}}, [], "the result of size cannot be read"),
        ({"params": {"mean": 3, "units": "kPa"}}, [Value("elasticity", 3.0, None, "kPa")], "names no property"),
        (
            {"meas_prop": "mass", "params": {"mean": math.nan, "sigma": 2}},
            [FailedEntry("the mean is nan", "mass")],
            "failed",
        ),
        (
            {"meas_prop": "mass", "params": {"mean": 1, "sigma": -2, "units": "g"}},
            [Value("mass", 1.0, None, "g")],
            "no SD",
        ),
        (
            {"meas_prop": "density", "params": {"mean": 9, "units": "kg/m^3"}},
            [Value("density", 9.0, None, "kg/m^3")],
            "",
        ),
        ({"meas_prop": "mass", "params": "heavy"}, [], "cannot be read"),
        ({"hello": 1}, [], "states no result that can be read"),
        (
            {"measurement": {}, "entry": {"name": "mass", "values": [{"mean": 1.5, "units": "g", "name": "mass"}]}},
            [Value("mass", 1.5, None, "g")],
            "",
        ),
        (
            {"entry": [{"name": "a", "values": [{"mean": 1}]}, {"name": "b", "values": [{"mean": 2}]}]},
            [Value("a", 1.0), Value("b", 2.0)],
            "",
        ),
    ],
)
def test_results_in_many_forms(tmp_path: Path, result: Any, entries: list[Entry], notice: str) -> None:
    """Each form of a result becomes an entry; what is unclear is noticed and kept in the file."""
    found = read_measurement(measurement(experiment(tmp_path), {"data/measurement.json": result}))
    assert list(found.entries) == entries
    assert told(found, notice)
    assert "data/measurement.json" in {item.name for item in found.files}


def test_grams_in_a_torque_are_the_mass(tmp_path: Path) -> None:
    """Where the arm's series of grams was logged, the density derived from it is no result."""
    folder = measurement(
        experiment(tmp_path),
        {
            "data/measurement.json": {"meas_prop": "density", "params": {"mean": 254, "sigma": 800}},
            "data/forces.json": {"tentacle": {"joint4_torque": [99.0, 101.0]}},
        },
        "density_0",
    )
    found = read_measurement(folder)
    assert (found.action, found.entries) == ("weighing", (Value("mass", 100.0, None, "g"),))
    assert told(found, "is derived, not measured")


def test_probabilities_that_do_not_sum_to_one_are_refused(tmp_path: Path) -> None:
    """What a store would not keep is refused with the reason."""
    result = {"meas_prop": "kind", "meas_type": "categorical", "params": {"mug": 0.5}}
    with pytest.raises(StoreError, match=r"sum to 0\.5"):
        read_measurement(measurement(experiment(tmp_path), {"data/measurement.json": result}))


@pytest.mark.parametrize(
    ("content", "series"),
    [
        ([1.0, 2.0], {"x": {"x": [1.0, 2.0]}}),
        ({"a": [1, 2], "b": [3, 4]}, {"x": {"a": [1, 2], "b": [3, 4]}}),
        ({"hand": {"a": [1.5]}, "foot": {"a": [2, 3]}}, {"hand": {"a": [1.5]}, "foot": {"a": [2, 3]}}),
        ({"a": [1, 2], "b": [3]}, None),
        ([[1, 2], [3, 4]], None),
        ([1, "2"], None),
        ([1, True], None),
        ([10**17], None),
        ({"hand": {"a": [1.5]}, "name": "me"}, None),
        ([], None),
        ({}, None),
        (7, None),
        ("[1, 2", None),
    ],
)
def test_numbers_become_series_where_they_are_clear(tmp_path: Path, content: Any, series: Any) -> None:
    """Lists of numbers are series; anything else is kept as the file that it is."""
    folder = measurement(experiment(tmp_path), {"data/forces.json": None, "data/x.json": content})
    found = read_measurement(folder)
    lists = {one.name: {channel.name: channel.values.tolist() for channel in one.channels} for one in found.series}
    assert lists == (series or {})
    assert ("data/x.json" in {item.name for item in found.files}) == (series is None)


def test_samples_that_are_there_twice(tmp_path: Path) -> None:
    """Samples of a device that the measurement has already stay in their file."""
    folder = measurement(experiment(tmp_path), {"data/measurement.json": {**RESULT, "sensor_outputs": SQUEEZE}})
    found = read_measurement(folder)
    assert [series.name for series in found.series] == ["claw"]
    assert "data/forces.json" in {item.name for item in found.files}
    assert told(found, "there are samples of claw already")


@pytest.mark.parametrize(
    "name", ["../secret", "../../secret.json", "/etc/passwd", "C:\\x\\img.png", "\\\\host\\share\\x.png", "out.png"]
)
def test_paths_that_lead_out_are_not_read(tmp_path: Path, name: str) -> None:
    """Whatever path a measurement names, what is outside its folder is never in the recording."""
    write(tmp_path / "secret", b"secret")
    folder = measurement(
        experiment(tmp_path),
        {"data/measurement.json": {**RESULT, "sensor_outputs": {"eye": {"image": name}}}},
    )
    (folder / "out.png").symlink_to(tmp_path / "secret")
    found = read_measurement(folder)
    assert told(found, "leads out of the folder: it is not read")
    assert told(found, "'out.png' is refused: it is a link that leads out of its folder")
    assert file_digest(b"secret") not in {item.sha256 for item in found.files}


@pytest.mark.parametrize("part", ["log.txt", "data", "imgs", "data/measurement.json", "data/forces.json"])
def test_links_that_lead_out_are_not_followed(tmp_path: Path, part: str) -> None:
    """Each part of a measurement may be a link: nothing behind one that leads out is read."""
    outside = measurement(
        experiment(tmp_path / "outside"),
        {
            "log.txt": "secret",
            "data/forces.json": [6.25],
            "imgs/cam0.png": b"other",
            "data/measurement.json": {"meas_prop": "secret", "values": 1},
        },
    )
    folder = measurement(experiment(tmp_path))
    target = folder / part
    if target.is_dir():
        for inner in target.iterdir():
            inner.unlink()
        target.rmdir()
    else:
        target.unlink()
    target.symlink_to(outside / part)
    found = read_measurement(folder)
    assert told(found, f"{part!r} is refused")
    assert "secret" not in found.log + found.document
    assert all("x" not in series.name for series in found.series)
    assert [6.25] not in [channel.values.tolist() for series in found.series for channel in series.channels]


def test_a_setup_that_leads_out_is_not_read(tmp_path: Path) -> None:
    """A link in place of the setup is refused, and noticed."""
    write(tmp_path / "secret.json", {"arm": "secret"})
    folder = experiment(tmp_path, setup=None)
    (folder / "setup.json").symlink_to(tmp_path / "secret.json")
    found = read_measurement(measurement(folder))
    assert found.setup.devices == ()
    assert told(found, "setup.json")


def test_links_in_circles_and_pipes(tmp_path: Path) -> None:
    """A link to itself, a link to a folder above, and a pipe are left out and waited for by nobody."""
    folder = measurement(experiment(tmp_path), {"log.txt": None})
    (folder / "log.txt").symlink_to(folder / "log.txt")
    (folder / "up").symlink_to(folder.parent)
    (folder / "in").symlink_to(folder / "imgs")
    os.mkfifo(folder / "data" / "pipe.json")
    found = read_measurement(folder)
    assert told(found, "'up' is refused")
    for name in ("in", "data/pipe.json"):
        assert told(found, f"{name!r} is left out: it is no file")


def test_names_that_others_do_not_allow(tmp_path: Path) -> None:
    """A name with a colon, or with bytes that are no text, is changed and noticed."""
    folder = measurement(experiment(tmp_path), {"imgs/12:30.png": b"1"})
    (folder / os.fsdecode(b"\xff.bin")).write_bytes(b"2")
    found = read_measurement(folder)
    assert {"imgs/12_30.png", "_.bin"} <= {item.name for item in found.files}
    assert told(found, "'imgs/12_30.png' is renamed")


def test_a_log_that_is_no_text(tmp_path: Path) -> None:
    """Bytes that are no UTF-8 stay readable in the log."""
    found = read_measurement(measurement(experiment(tmp_path), {"log.txt": b"caf\xe9\n"}))
    assert found.log == "caf\\xe9\n"


numbers = st.integers() | st.floats() | st.sampled_from([10**400, -(10**30), 2**53 + 1, 1e308])
texts = st.text(max_size=4) | st.sampled_from(["mean", "probability", "mass", "kPa", "\0", "../x", "\ud800"])
junk = st.recursive(
    st.none() | st.booleans() | numbers | texts,
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(texts, inner, max_size=3),
    max_leaves=6,
)
KEYS = [
    *RESULT,
    "values",
    "meas_type",
    "entry",
    "measurement",
    "sensor_outputs",
    "object_pose",
    "object_instance",
    "setup",
]
FILES = ["data/measurement.json", "data/object_context.json", "data/forces.json", "data/x.json", "log.txt"]


@given(st.sampled_from(KEYS), junk, st.sampled_from([*FILES, "../setup.json"]), junk | st.binary(max_size=9), st.data())
@settings(max_examples=200)
def test_junk_anywhere_is_refused_or_kept(key: str, value: Any, file: str, content: Any, data: st.DataObject) -> None:
    """Whatever stands in any place of a tree, it is one sentence or a recording that a store keeps."""
    with TemporaryDirectory() as name:
        folder = measurement(experiment(Path(name), setup={**SETUP, "arm": data.draw(junk)}))
        write(folder / "data/measurement.json", {**RESULT, key: value})
        write(folder / file, content)
        with suppress(PalpateError):
            check(read_measurement(folder))


@given(st.lists(st.tuples(st.sampled_from([*FILES, "../setup.json"]), junk | st.binary(max_size=9)), max_size=4))
@settings(max_examples=25)
def test_any_tree_leaves_a_store_that_verifies(changes: list[tuple[str, Any]]) -> None:
    """Whatever is in one measurement, the other one is imported, and the store verifies."""
    from palpate.store.opening import open_store

    with TemporaryDirectory() as name, open_store(Path(name) / "s.sqlite", durable=False) as store:
        folder = experiment(Path(name) / "tree")
        measurement(folder, name="elasticity_1")
        changed = measurement(folder)
        for file, content in changes:
            write(changed / file, content)
        fates = [one.fate for one in import_paths(store, [folder], all_formats())]
        assert len(fates) == 2
        assert Fate.NEW in fates or any(file == "../setup.json" for file, _ in changes)
        assert list(verify(store)) == []
