import json
from pathlib import Path
from typing import Any

import numpy as np
import polars
import pyarrow.parquet as pq
import pytest

from palpate.store.entries import Distribution, Value
from palpate.store.opening import open_store
from palpate.store.records import Device, Setup, ThingRef
from tests.store.made_up import squeeze


@pytest.fixture
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A store with squeezings, a label and a second gripper, which the commands find by the environment."""
    path = tmp_path / "store.sqlite"
    monkeypatch.setenv("PALPATE_STORE", str(path))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    calibrated = Device("gripper", "another", calibration={"offset_N": 0.5}, calibrated_on="2024-05-01")
    with open_store(path) as store:
        store.put_many(squeeze(number) for number in range(4))
        store.put(squeeze(6, setup=Setup(gripper=calibrated)))
        store.put(squeeze(7, action="looking", entries=(Distribution("kind", {"mug": 0.9, "box": 0.1}),), series=()))
    return path


def test_results_are_printed_as_csv(run: Any, place: Path) -> None:
    """Each result is a row; filters and the order apply, and all recordings are there unless a limit is given."""
    printed = run("store", "list", "--format", "csv", "--ascending", "--gripper", "two_finger").out
    table = polars.read_csv(printed.encode())
    assert table["value"].to_list() == [40.0, 41.0, 42.0, 43.0, None]
    assert table["label"].to_list()[-1] == "mug"
    assert len(polars.read_csv(run("store", "list", "--format", "csv", "--limit", 2).out.encode())) == 2


def test_results_are_written_as_parquet(run: Any, place: Path, tmp_path: Path) -> None:
    """The file has the columns of an archive's results."""
    path = tmp_path / "results.parquet"
    assert run("store", "list", "--format", "parquet", "-o", path, "--property", "elasticity").code == 0
    found = pq.read_table(path)
    assert (found.num_rows, found["unit"].unique().to_pylist()) == (5, ["kPa"])
    assert {"recording", "value_si", "document", "ground_truth"} <= set(found.column_names)


def test_json_goes_to_a_file_too(run: Any, place: Path, tmp_path: Path) -> None:
    """What would be printed is written instead."""
    path = tmp_path / "page.json"
    assert run("store", "list", "--json", "--limit", 2, "-o", path).out == ""
    assert len(json.loads(path.read_text(encoding="utf-8"))["recordings"]) == 2


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--format", "parquet"], "--format parquet: is for a file, expected --output FILE"),
        (["--output", "x.txt"], "--output: a table is for people"),
        (["--format", "csv", "--cursor", "x"], "--cursor: is for pages"),
        (["--format", "csv", "--json"], "--json: is --format json, and --format csv was found; expected one of them"),
        (["--format", "table", "--json"], "--json: is --format json, and --format table was found"),
        (["--sort", "recorder"], "--sort: 'recorder' was found (did you mean 'recorded'?); choose from 'recorded'"),
        (["--format", "csv", "-o", "nowhere/x.csv"], "--output: the folder nowhere does not exist"),
        (["--known", "mug"], "--known: 'mug' was found, expected PROPERTY=LABEL"),
    ],
)
def test_options_that_do_not_fit_are_refused(run: Any, place: Path, arguments: list[str], message: str) -> None:
    """One sentence, and nothing is written."""
    assert message in run("store", "list", *arguments).refused


def test_the_table_of_objects_and_properties(run: Any, place: Path) -> None:
    """Means, SDs, counts and the spread between devices stand in a table, in JSON and in CSV."""
    told = " ".join(run("store", "table").out.split())
    assert "elasticity [kPa]" in told
    assert "43.0 ± 3.00 (3, devices ± 3.18)" in told
    cells = json.loads(run("store", "table", "--json").out)
    assert [(cell["thing"], cell["count"]) for cell in cells] == [("object0", 3), ("object1", 1), ("object2", 1)]
    rows = polars.read_csv(run("store", "table", "--format", "csv").out.encode())
    assert rows["mean"].to_list() == [cell["mean"] for cell in cells]


def test_curves_are_written_as_arrays(run: Any, place: Path, tmp_path: Path) -> None:
    """Every channel of the gripper is an array, with its time stamps, and with unit and rate told beside it."""
    path = tmp_path / "curves.npz"
    assert run("store", "curves", "--gripper", "two_finger", "-o", path).out == f"{path}: 12 channels\n"
    with np.load(path) as found:
        told = [json.loads(text) for text in found["channels"].tolist()]
        wanted = [channel for number in range(4) for channel in squeeze(number).series[0].channels]
        assert [(one["quantity"], one["unit"], one["rate_hz"]) for one in told] == [
            (channel.quantity, channel.unit, channel.rate_hz) for channel in wanted
        ]
        for one, channel in zip(told, wanted, strict=True):
            assert np.array_equal(found[one["array"]], channel.values)
            assert ("time_s" in one) == (channel.time_s is not None)
            if channel.time_s is not None:
                assert np.array_equal(found[one["time_s"]], channel.time_s)


def test_curves_are_written_as_a_table(run: Any, place: Path, tmp_path: Path) -> None:
    """Every channel of the gripper is a row; another action or gripper has none."""
    path = tmp_path / "curves.parquet"
    run("store", "curves", "--gripper", "another", "-o", path, "--action", "squeezing")
    rows = pq.read_table(path).to_pylist()
    for row, channel in zip(rows, squeeze(6).series[0].channels, strict=True):
        assert (row["channel"], row["unit"], row["shape"]) == (channel.name, channel.unit, list(channel.values.shape))
        assert np.array_equal(np.reshape(row["values"], row["shape"]), channel.values)
    none = ("--gripper", "another", "--action", "looking")
    assert run("store", "curves", *none, "-o", path).out == f"{path}: 0 channels\n"
    assert pq.read_table(path).num_rows == 0
    wrong = run("store", "curves", "--gripper", "two_finger", "-o", tmp_path / "x.csv").refused
    assert f"--output: '{tmp_path / 'x.csv'}' has no ending of a file of curves" in wrong
    before = set(tmp_path.iterdir())
    unknown = run("store", "curves", "--gripper", "two_fingers", "-o", tmp_path / "new.npz").refused
    assert "--gripper: the store has no gripper 'two_fingers' (did you mean 'two_finger'?)" in unknown
    assert set(tmp_path.iterdir()) == before


def test_devices_are_listed_with_their_calibration(run: Any, place: Path) -> None:
    """Each device and calibration has a row with its date."""
    told = " ".join(run("store", "devices").out.split())
    assert 'gripper another 2024-05-01 {"offset_N": 0.5} 1' in told
    (found,) = json.loads(run("store", "devices", "two_finger", "--json").out)
    assert (found["recordings"], found["calibrated_on"]) == (5, None)


def test_recordings_are_found_by_what_is_known(run: Any, place: Path) -> None:
    """Ground truth of an object finds its recordings."""
    with open_store(place) as store:
        truth = (Distribution("kind", {"mug": 1.0}), Value("mass", 1.0, unit="g"))
        store.put(squeeze(9, entries=truth, ground_truth=True))
    rows = json.loads(run("store", "list", "--known", "kind=mug", "--json").out)["recordings"]
    assert {row["thing"] for row in rows} == {"object0"}
    assert len(rows) == 4
    both = run("store", "list", "--known", "kind=box", "--known", "kind=mug", "--json")
    assert "--known: the store has no known label of kind 'box'" in both.err


UNKNOWN = {
    ("--object", "objekt1"): "--object: the store has no object 'objekt1' (did you mean 'object1'?)",
    ("--dataset", "made-up"): "--dataset: the store has no dataset 'made-up' (did you mean 'made_up'?)",
    ("--action", "sqeezing"): "'sqeezing' (did you mean 'squeezing'?); choose from 'looking', 'squeezing'",
    ("--property", "elastisity"): "--property: the store has no property 'elastisity' (did you mean 'elasticity'?)",
    ("--device", "two_fingr"): "--device: the store has no device 'two_fingr' (did you mean 'two_finger'?)",
    ("--gripper", "two_fingr"): "--gripper: the store has no gripper 'two_fingr' (did you mean 'two_finger'?)",
    ("--owner", "ann"): "--owner: the store has no owner 'ann'",
    ("--label", "kin=mug"): "--label: the store has no property 'kin' (did you mean 'kind'?)",
    ("--label", "kind=mugg"): "--label: the store has no label of kind 'mugg' (did you mean 'mug'?)",
    ("--known", "kind=box"): "--known: the store has no known property 'kind'",
}


@pytest.mark.parametrize("typed", UNKNOWN)
def test_a_name_that_the_store_does_not_know_is_refused(run: Any, place: Path, tmp_path: Path, typed: Any) -> None:
    """In every form, and by an export too; nothing is written, and the name that was meant is proposed."""
    before = set(tmp_path.iterdir())
    for command in (
        ("list",),
        ("list", "--json"),
        ("list", "--format", "csv"),
        ("export", tmp_path / "new"),
    ):
        assert UNKNOWN[typed] in run("store", *command, *typed).refused
    assert set(tmp_path.iterdir()) == before


def test_what_matches_nothing_says_so(run: Any, place: Path, tmp_path: Path) -> None:
    """Names that are known but do not meet are no error: in words for people, and empty for programs."""
    none = ("--action", "looking", "--gripper", "another")
    assert run("store", "list", *none) == run("store", "list", "--text", "xyz")
    assert (run("store", "list", *none).code, run("store", "list", *none).out) == (0, "no recording matches\n")
    assert json.loads(run("store", "list", *none, "--json").out)["recordings"] == []
    assert len(run("store", "list", *none, "--format", "csv").out.splitlines()) == 1
    assert run("store", "episodes", "--object", "object1").out == "no episode matches\n"
    assert "(did you mean 'object1'?)" in run("store", "episodes", "--object", "objekt1").refused
    assert "NAME: the store has no device 'two_fingr'" in run("store", "devices", "two_fingr").refused


def test_a_store_without_anything_says_so(run: Any, place: Path, tmp_path: Path) -> None:
    """Lists of nothing are sentences and no bare headers."""
    open_store(tmp_path / "empty.sqlite").close()
    told = {"list": "recordings", "episodes": "episodes", "objects": "objects", "devices": "devices"}
    for command, what in (told | {"table": "measured values"}).items():
        assert run("store", command, "--store", tmp_path / "empty.sqlite").out == f"no {what} yet\n"


def test_hidden_letters_of_older_stores_are_escapes(run: Any, tmp_path: Path) -> None:
    """In tables and in what a command says; as JSON they are what they were."""
    place, name = tmp_path / "old.sqlite", "cup\u202e\x1b[2J"
    with open_store(place) as store:
        store.put_checked([squeeze(1, thing=ThingRef("lab", name), setup=Setup(gripper=Device("gripper", name)))])
    where = ("--store", place)
    for command in ("list", "devices", "objects"):
        told = run("store", *command.split(), *where).out
        assert r"cup\u202e\x1b[2J" in told, command
        assert not {"\u202e", "\x1b"} & set(told), command
    rows = json.loads(run("store", "list", "--json", *where).out)["recordings"]
    assert rows[0]["thing"] == name
    assert r"lab/cup\u202e\x1b[2J" in run("store", "object", "split", f"lab/{name}", *where).err
    new = run("store", "object", "add", f"lab/new {name}", *where)
    assert new.err.startswith("palpate: thing.id: letter 8 is U+202E RIGHT-TO-LEFT OVERRIDE, which nobody sees in")
