import json
import math
from contextlib import suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.errors import LogError
from palpate.store.checks import check
from palpate.store.entries import Distribution, FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.uploads import UploadDictionaries, read_upload
from palpate.store.opening import open_store
from palpate.store.store import Store
from palpate.store.verifying import verify

POSE = {"rotation": [1.0, 2.0, 3.0], "translation": [0.1, 0.2, 0.3]}
GRIP = {"hand": {"position": [1.0, 2.0], "time": [0.0, 1.0]}}
ODD_NAME = "upload_dict_2001_02_03_04_05_06_{}.json"


def number(name: str, **values: Any) -> dict[str, Any]:
    return {"name": name, "type": "continuous", "values": [values], "repository": None}


def labels(name: str, **probabilities: float) -> dict[str, Any]:
    values = [{"name": label, "probability": p} for label, p in probabilities.items()]
    return {"name": name, "type": "categorical", "values": values, "repository": "https://example.org/eyes"}


def upload(folder: Path, name: str, entry: Any, outputs: Any, **measurement: Any) -> Path:
    """Write an invented upload dictionary."""
    given = {
        "object_instance": {"common_name": "teapot", "dataset": "pots", "dataset_id": "07"},
        "setup": {"arm": "tentacle", "camera": "eye", "algorithm": "https://example.org/wave"},
        "sensor_outputs": outputs,
        "grasp": None,
        "object_pose": POSE,
        "gripper_pose": {**POSE, "grasped": False},
    }
    path = folder / ODD_NAME.format(name)
    path.write_text(json.dumps({"measurement": {**given, **measurement}, "entry": entry}))
    return path


def test_a_squeeze_is_read(tmp_path: Path) -> None:
    """Object, devices, poses, series and result are where they belong, and what was assumed is told."""
    found = read_upload(upload(tmp_path, "elasticity_0", number("elasticity", mean=42.0, std=4.5, units=None), GRIP))
    assert found.action == "squeezing"
    assert (found.thing.dataset, found.thing.id, found.thing.common_name) == ("pots", "07", "teapot")
    assert [(device.kind, device.name) for device in found.setup.devices] == [
        ("arm", "tentacle"),
        ("camera", "eye"),
        ("other", "https://example.org/wave"),
    ]
    assert found.entries == (Value("elasticity", 42.0, 4.5, "kPa"),)
    assert [channel.name for channel in found.series[0].channels] == ["position", "time"]
    assert found.gripper_pose is not None
    assert found.gripper_pose.original["rotation"] == [1.0, 2.0, 3.0]
    assert found.recorded_at.isoformat() == "2001-02-03T04:05:06+00:00"
    for told in ("UTC is assumed", "kPa is assumed", "metres are assumed", "no convention", "an index resampled"):
        assert any(told in notice for notice in found.notices)


def test_a_mean_that_is_no_number_has_failed(tmp_path: Path) -> None:
    """NaN becomes a failed entry, with its series kept, and not a number."""
    found = read_upload(upload(tmp_path, "elasticity_0", number("elasticity", mean=math.nan, std=4.5), GRIP))
    assert found.entries == (FailedEntry("the mean is nan", "elasticity"),)
    assert found.series


def test_grams_are_no_torque(tmp_path: Path) -> None:
    """The weighing is the mean of the grams; the derived density is in the file of the entry and nowhere else."""
    outputs = {"tentacle": {"joint4_torque": [99.0, 101.0, 103.0]}}
    found = read_upload(upload(tmp_path, "density_0", number("density", mean=254.0, std=800), outputs))
    assert found.entries == (Value("mass", 101.0, None, "g"),)
    assert (found.series[0].channels[0].quantity, found.series[0].channels[0].unit) == ("mass", "g")
    original = next(item for item in found.files if item.name == "entry.json")
    assert isinstance(original.data, bytes)
    assert json.loads(original.data)["values"][0]["mean"] == 254.0


def test_labels_are_kept_as_they_are(tmp_path: Path) -> None:
    """All labels are kept, those too that no network knows."""
    found = read_upload(upload(tmp_path, "mat-vision_0", labels("mat-vision", plastic=0.75, water=0.25), {}))
    assert found.entries == (Distribution("material", {"plastic": 0.75, "water": 0.25}),)
    assert found.repository == "https://example.org/eyes"
    assert "the label 'plastic' may stand for soft-plastic or hard-plastic: it is kept as it is" in found.notices


@pytest.mark.parametrize(
    "name", ["../secret.png", "/etc/passwd", "C:\\x\\img.png", "link.png", "\\\\host\\share\\x.png"]
)
def test_files_outside_the_folder_are_never_read(tmp_path: Path, name: str) -> None:
    """A path that leads out is refused and noticed, without the folders of the other computer."""
    (tmp_path / "secret.png").write_bytes(b"secret")
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "link.png").symlink_to(tmp_path / "secret.png")
    file = upload(folder, "cat-vision_0", labels("cat-vision", mug=1.0), {"eye": {"image": name}})
    found = read_upload(file)
    assert [item.name for item in found.files] == ["entry.json"]
    assert any("is refused" in notice and "etc" not in notice for notice in found.notices)


def test_files_beside_it_are_kept(tmp_path: Path) -> None:
    """A file inside the folder comes along; one that is not there is noticed."""
    (tmp_path / "imgs").mkdir()
    (tmp_path / "imgs" / "a.png").write_bytes(b"picture")
    outputs = {"eye": {"image": "imgs/a.png", "other": "imgs/b.png"}}
    found = read_upload(upload(tmp_path, "cat-vision_0", labels("cat-vision", mug=1.0), outputs))
    assert (found.files[0].name, found.files[0].media_type) == ("eye/image.png", "image/png")
    assert any("'b.png', is not there" in notice for notice in found.notices)


@pytest.mark.parametrize("name", ["C:\\lab\\data\\img_cam1.png", "/home/lab/data/img_cam1.png"])
def test_a_picture_of_another_computer_is_the_one_beside_it(local: Store, tmp_path: Path, name: str) -> None:
    """Where a path leads on the computer that wrote it says nothing here; a file of its name beside it does."""
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "img_cam1.png").write_bytes(b"picture")
    upload(folder, "cat-vision_0", labels("cat-vision", mug=1.0), {"eye": {"image": name}})
    (done,) = import_paths(local, [folder], [UploadDictionaries()])
    assert done.fate is Fate.NEW
    assert done.recording is not None
    assert [item.name for item in done.recording.files] == ["eye/image.png", "entry.json"]
    assert not any("refused" in notice for notice in done.recording.notices)
    assert any("'img_cam1.png', is the one beside it" in notice for notice in done.recording.notices)


def test_a_link_beside_it_is_no_file_of_another_computer(tmp_path: Path) -> None:
    """What lies beside it counts only where it is inside the folder, and a relative path is as it says."""
    (tmp_path / "secret.png").write_bytes(b"secret")
    folder = tmp_path / "folder"
    folder.mkdir()
    (folder / "img.png").symlink_to(tmp_path / "secret.png")
    (folder / "own.png").write_bytes(b"own")
    outputs = {"eye": {"image": "C:\\lab\\img.png", "other": "../own.png", "third": "C:\\"}}
    found = read_upload(upload(folder, "cat-vision_0", labels("cat-vision", mug=1.0), outputs))
    assert [item.name for item in found.files] == ["entry.json"]
    assert sum("is refused" in notice for notice in found.notices) == 3


def test_an_import_can_be_run_again(local: Store, tmp_path: Path) -> None:
    """The second import finds everything there; ids and digests are the same."""
    upload(tmp_path, "elasticity_0", number("elasticity", mean=42.0, std=4.5, units="kPa"), GRIP)
    upload(tmp_path, "mat-vision_0", labels("mat-vision", plastic=1.0), {})
    first, again = (list(import_paths(local, sorted(tmp_path.glob("*.json")), [UploadDictionaries()])) for _ in "ab")
    assert [done.fate for done in first] == [Fate.NEW, Fate.NEW]
    assert [done.fate for done in again] == [Fate.KNOWN, Fate.KNOWN]
    assert [done.recording and done.recording.id for done in first] == [
        done.recording and done.recording.id for done in again
    ]


def test_one_bad_file_spoils_no_other(local: Store, tmp_path: Path) -> None:
    """A file that is refused is told with the reason; the others are taken."""
    bad = upload(tmp_path, "a-bad-one_0", labels("mat-vision", plastic=0.6), {})
    good = upload(tmp_path, "mat-vision_0", labels("mat-vision", plastic=1.0), {})
    broken = tmp_path / ODD_NAME.format("zero_0")
    broken.write_text("{")
    done = {one.source: one for one in import_paths(local, [bad, good, broken], [UploadDictionaries()])}
    assert [done[str(file)].fate for file in (bad, good, broken)] == [Fate.REFUSED, Fate.NEW, Fate.REFUSED]
    assert "sum to 0.6" in str(done[str(bad)].reason)
    assert "no readable JSON" in str(done[str(broken)].reason)


junk = st.recursive(
    st.none() | st.booleans() | st.integers() | st.just(10**400) | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=5), inner, max_size=3),
    max_leaves=4,
)
PLACES = [
    ("measurement",),
    ("entry",),
    ("entry", "values"),
    ("entry", "name"),
    ("entry", "repository"),
    ("measurement", "object_instance"),
    ("measurement", "object_instance", "dataset"),
    ("measurement", "object_instance", "common_name"),
    ("measurement", "setup"),
    ("measurement", "setup", "arm"),
    ("measurement", "sensor_outputs"),
    ("measurement", "sensor_outputs", "hand"),
    ("measurement", "sensor_outputs", "hand", "position"),
    ("measurement", "grasp"),
    ("measurement", "object_pose"),
    ("measurement", "object_pose", "translation"),
]


@given(st.sampled_from(PLACES), junk)
@settings(max_examples=150)
def test_junk_anywhere_is_refused_or_kept(place: tuple[str, ...], value: Any) -> None:
    """Whatever stands in any place of a file, it is one sentence or a recording that a store keeps."""
    with TemporaryDirectory() as name:
        file = upload(Path(name), "elasticity_0", number("elasticity", mean=1.0, std=1.0, units="kPa"), GRIP)
        content = json.loads(file.read_text())
        inner = content
        for key in place[:-1]:
            inner = inner[key]
        inner[place[-1]] = value
        file.write_text(json.dumps(content))
        with suppress(LogError, StoreError):
            check(read_upload(file))


@given(st.lists(st.tuples(st.sampled_from(PLACES), junk), max_size=3), st.binary(max_size=20))
@settings(max_examples=25)
def test_mutated_files_leave_a_store_that_verifies(changes: list[tuple[tuple[str, ...], Any]], torn: bytes) -> None:
    """Whatever was changed in one file, or stands in another, the good one is imported and the store verifies."""
    with TemporaryDirectory() as name, open_store(Path(name) / "store.sqlite", durable=False) as store:
        folder = Path(name) / "given"
        folder.mkdir()
        upload(folder, "mat-vision_0", labels("mat-vision", plastic=1.0), {})
        (folder / ODD_NAME.format("torn_0")).write_bytes(torn)
        content = json.loads(upload(folder, "elasticity_0", number("elasticity", mean=1.0), GRIP).read_text())
        for place, value in changes:
            inner = content
            for key in place[:-1]:
                inner = inner[key] if isinstance(inner, dict) and key in inner else {}
            if isinstance(inner, dict):
                inner[place[-1]] = value
        (folder / ODD_NAME.format("elasticity_0")).write_text(json.dumps(content))
        fates = [outcome.fate for outcome in import_paths(store, [folder], [UploadDictionaries()])]
        assert len(fates) == 3
        assert Fate.NEW in fates
        assert list(verify(store)) == []


def test_a_file_that_is_named_about_so_is_refused_with_the_form(tmp_path: Path) -> None:
    """What begins and ends like an upload dictionary is meant to be one: the right form is told, with an example."""
    given = upload(tmp_path, "elasticity_0", number("elasticity", mean=42.0, std=4.5, units="kPa"), GRIP)
    names = ("upload_dict_1.json", "upload_dict_20240501T120000_0_0.json", "upload_dict.json", "Upload_Dict_a.JSON")
    for name in names:
        (tmp_path / name).write_bytes(given.read_bytes())
    digits = tmp_path / "upload_dict_20240501120000_elasticity_0.json"
    given.rename(digits)
    with open_store(tmp_path / "store.sqlite", tmp_path / "blobs", durable=False) as store:
        found = {Path(one.source).name: one for one in import_paths(store, [tmp_path], [UploadDictionaries()])}
    for name in names:
        assert found[name].fate is Fate.REFUSED
        reason = found[name].reason or ""
        assert "upload_dict_<time>_<entry>_<number>.json" in reason
        assert "year_month_day_hour_minute_second" in reason
        assert "upload_dict_2024_05_01_12_00_00_elasticity_0.json" in reason
    assert "expected year_month_day_hour_minute_second" in (found[digits.name].reason or "")
