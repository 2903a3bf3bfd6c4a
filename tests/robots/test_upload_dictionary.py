import json
import math
from pathlib import Path
from typing import Any

import pytest

from palpate.errors import LogError
from palpate.inference.exact import ExactBelief
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.outcomes import Failed, Label, Posterior, Reading
from palpate.robots.session import read_session, write_session
from palpate.robots.upload_dictionary import convert

POSE = {"rotation": [1.0, 2.0, 3.0], "translation": [0.1, 0.2, 0.3]}


@pytest.fixture(scope="module")
def network() -> Any:
    return load_network("household")


def entry(name: str, **values: Any) -> Any:
    return {"name": name, "type": "continuous", "values": [values], "repository": None}


def classes(entry_name: str, **probabilities: float) -> Any:
    values = [{"name": label.replace("_", "-"), "probability": p} for label, p in probabilities.items()]
    return {"name": entry_name, "type": "categorical", "values": values, "repository": None}


def upload(folder: Path, name: str, its_entry: Any, outputs: Any, thing: Any = "teapot") -> Any:
    """Write an invented upload dictionary."""
    measurement = {
        "object_instance": {"common_name": thing},
        "setup": {"arm": "tentacle", "camera": "eye"},
        "sensor_outputs": outputs,
        "grasp": None,
        "object_pose": POSE,
        "gripper_pose": {**POSE, "grasped": False},
    }
    path = folder / f"upload_dict_2001_01_01_00_00_00_{name}.json"
    path.write_text(json.dumps({"measurement": measurement, "entry": its_entry}))
    return path


IMAGE = {"eye": {"image": "C:\\Users\\somebody\\data\\img.png"}}
LOAD = {"tentacle": {"joint4_torque": [99.0, 101.0, 103.0]}}
GRIP = {"hand": {"position": [1.0, 2.0], "time": [0.0, 1.0]}}


@pytest.fixture
def folder(tmp_path: Path) -> Any:
    upload(tmp_path, "density_0", entry("density", mean=254.0, std=800, units=None), LOAD)
    upload(tmp_path, "elasticity_3", entry("elasticity", mean=math.nan, std=4.5, units=None), GRIP)
    upload(tmp_path, "mat-vision_0", classes("mat-vision", plastic=0.6, glass=0.3, other=0.1), IMAGE)
    upload(tmp_path, "cat-vision_0", classes("cat-vision", kettle=0.7, box=0.3, pan=0.0), IMAGE)
    return tmp_path


def outcomes(session: Any) -> Any:
    return dict(session.recorded)


def test_recordings_are_in_the_order_of_the_actions(folder: Path, network: Network) -> None:
    """The order of recording is not known: the network's is taken, and told."""
    session = convert(folder, network, source="invented")
    assert [r.action for r in session.recordings] == ["cat-vision", "mat-vision", "squeezing", "weighing"]
    assert session.object == "teapot"
    assert any("order" in decision for decision in session.decisions)


def test_a_mean_that_is_no_number_is_a_failed_reading(folder: Path, network: Network) -> None:
    """A NaN squeeze is a failed reading, with its series kept."""
    session = convert(folder, network, source="invented")
    assert isinstance(outcomes(session)["squeezing"], Failed)
    assert session.recordings[2].series["hand.position"] == [1.0, 2.0]
    assert any("resampled" in decision for decision in session.recordings[2].decisions)


def test_the_weighing_is_the_mean_of_the_grams(folder: Path, network: Network) -> None:
    """joint4_torque is grams: its mean is the reading, and the derived density is kept but no evidence."""
    weighing = convert(folder, network, source="invented").recordings[3]
    assert weighing.outcome == Reading(101.0, unit="g")
    assert weighing.units == {"tentacle.joint4_torque": "g"}
    assert weighing.entry["values"][0]["mean"] == 254.0
    assert any("grams" in decision for decision in weighing.decisions)
    assert any("never used as evidence" in decision for decision in weighing.decisions)


def test_plastic_is_split_by_the_prior(folder: Path, network: Network) -> None:
    """In a vector, plastic goes to the two plastic states in proportion to their prior."""
    found = outcomes(convert(folder, network, source="invented"))["mat-vision"]
    material = network.property("material")
    assert isinstance(material, CategoricalProperty)
    prior = dict(zip(material.states, ExactBelief(network).probabilities("material"), strict=True))
    both = prior["soft-plastic"] + prior["hard-plastic"]
    assert found.probabilities["soft-plastic"] == pytest.approx(0.6 * prior["soft-plastic"] / both)
    assert found.probabilities["hard-plastic"] == pytest.approx(0.6 * prior["hard-plastic"] / both)
    assert "plastic" not in found.probabilities


def test_plastic_as_a_label_is_the_outcome_soft_plastic(folder: Path, network: Network) -> None:
    """As a label, plastic is the sensor's outcome soft-plastic; a label it does not know is failed."""
    found = outcomes(convert(folder, network, source="invented", labels=True))
    assert found["mat-vision"] == Label("soft-plastic")
    assert found["cat-vision"] == Failed("label 'kettle' is not known")


def test_unknown_labels_are_kept_for_admission(folder: Path, network: Network) -> None:
    """Labels that are no states stay in the vector, so that admission decides and tells."""
    camera = convert(folder, network, source="invented").recordings[0]
    assert camera.outcome == Posterior({"kettle": 0.7, "box": 0.3, "pan": 0.0})
    assert any("'kettle' 0.7000, 1 of probability zero" in decision for decision in camera.decisions)


def test_files_are_named_without_their_folders(folder: Path, network: Network) -> None:
    """Raw files that are not there are named, and the other computer's folders are not."""
    camera = convert(folder, network, source="invented").recordings[0]
    assert camera.files == {"eye.image": "img.png (not there)"}


def test_a_reading_keeps_to_the_sensors_sd(tmp_path: Path, network: Network) -> None:
    """A usable mean is a reading in the assumed unit; its std is kept and not used."""
    upload(tmp_path, "elasticity_0", entry("elasticity", mean=42.0, std=4.5, units=None), GRIP)
    (squeeze,) = convert(tmp_path, network, source="invented").recordings
    assert squeeze.outcome == Reading(42.0, unit="kPa")
    assert any("kPa is assumed" in decision for decision in squeeze.decisions)
    assert any("4.5 is kept and not used" in decision for decision in squeeze.decisions)


def test_a_conversion_survives_its_file(
    folder: Path, network: Network, tmp_path_factory: pytest.TempPathFactory
) -> None:
    """A converted session is written and read back with the same outcomes and decisions."""
    session = convert(folder, network, source="invented")
    path = tmp_path_factory.mktemp("session") / "teapot.jsonl"
    write_session(session, path)
    again = read_session(path)
    assert again.recorded == session.recorded
    assert again.all_decisions == session.all_decisions


def test_an_empty_folder_is_told(tmp_path: Path, network: Network) -> None:
    """A folder without upload dictionaries is a LogError."""
    with pytest.raises(LogError, match="no file upload_dict_"):
        convert(tmp_path, network, source="invented")


def test_recordings_of_two_objects_are_told(folder: Path, network: Network) -> None:
    """A session is of one object."""
    upload(folder, "mat-sound_0", classes("mat-sound", glass=1.0), {}, thing="kettle")
    with pytest.raises(LogError, match="recordings of kettle, teapot were found, expected one object"):
        convert(folder, network, source="invented")


@pytest.mark.parametrize(
    ("content", "told"),
    [
        ("{", "no readable JSON"),
        ("{}", "measurement is missing"),
        ('{"measurement": {"object_instance": {"common_name": "x"}}}', "entry is missing"),
        ("[]", "measurement is missing"),
    ],
)
def test_a_bad_dictionary_names_the_file(tmp_path: Path, network: Network, content: str, told: str) -> None:
    """A dictionary that cannot be read or lacks a key is a LogError with the file's name."""
    (tmp_path / "upload_dict_2001_01_01_00_00_00_density_0.json").write_text(content)
    with pytest.raises(LogError, match=f"density_0.json: .*{told}"):
        convert(tmp_path, network, source="invented")


def test_an_entry_of_no_action_is_told(tmp_path: Path, network: Network) -> None:
    """An entry that is of no action of the network names the valid ones."""
    upload(tmp_path, "taste_0", entry("taste", mean=1.0), {})
    with pytest.raises(LogError, match="'taste' is of no action; choose from 'cat-vision'"):
        convert(tmp_path, network, source="invented")


def test_files_and_folders_are_the_same(folder: Path, network: Network) -> None:
    """Files named one by one, their folder, or both give the same session, each recording once."""
    files = sorted(folder.iterdir())
    whole = convert(folder, network, source="invented")
    for paths in (files, [folder], [*files, folder]):
        assert convert(paths, network, source="invented").recorded == whole.recorded
    assert [r.action for r in convert(files[:1], network, source="invented").recordings] == ["cat-vision"]


def test_a_file_of_another_name_is_told(folder: Path, network: Network) -> None:
    """A file whose name does not tell entry and time is refused with the form it should have."""
    other = (folder / "upload_dict_2001_01_01_00_00_00_density_0.json").rename(folder / "density.json")
    with pytest.raises(LogError, match=r"density.json: a name of the form upload_dict_<time>_"):
        convert([other], network, source="invented")


@pytest.mark.parametrize("outputs", [[], {"hand": []}, {"hand": {"force": None}}, {"hand": {"force": ["much"]}}])
def test_odd_signals_are_told(tmp_path: Path, network: Network, outputs: Any) -> None:
    """Signals that are neither numbers nor a file are refused with the file and the place."""
    upload(tmp_path, "elasticity_0", entry("elasticity", mean=42.0), outputs)
    with pytest.raises(LogError, match=r"elasticity_0.json: measurement.sensor_outputs.* expected"):
        convert(tmp_path, network, source="invented")


@pytest.mark.parametrize("value", [3, {"name": "box"}, {"name": "box", "probability": "much"}, {"probability": 0.5}])
def test_odd_probabilities_are_told(tmp_path: Path, network: Network, value: Any) -> None:
    """A classifier's value without a name and a probability is refused with the file and the key."""
    found = {"name": "cat-vision", "type": "categorical", "values": [{"name": "mug", "probability": 0.5}, value]}
    upload(tmp_path, "cat-vision_0", found, {})
    with pytest.raises(LogError, match=r"cat-vision_0.json: entry.values: a name and a probability were expected"):
        convert(tmp_path, network, source="invented")
