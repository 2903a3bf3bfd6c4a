import json
import shutil
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from palpate.store.errors import StoreError
from palpate.store.exporting import shards
from palpate.store.exporting.lerobot import frames
from palpate.store.exporting.lerobot.dataset import LeRobot
from palpate.store.exporting.lerobot.resampling import Linear, Nearest
from palpate.store.filters import Filter
from palpate.store.opening import open_store
from palpate.store.records import Channel, FileItem, Recording, Series
from palpate.store.store import Store
from tests.store.exporting.lerobot.reader import Dataset, png, read
from tests.store.exporting.shared import TERMS, public, written
from tests.store.made_up import recordings


def exported(store: Store, folder: Path, **settings: Any) -> Dataset:
    written(store, LeRobot(TERMS, **settings), folder)
    return read(folder)


def ramp(name: str, count: int, **time: Any) -> Channel:
    """A channel whose samples say when they were, if there are ten each second."""
    return Channel(name, "time", "s", np.arange(count) / 10, **time)


def moved(*channels: Channel) -> Recording:
    return public(1, series=(Series("robot", channels),))


def test_recordings_are_episodes(local: Store, tmp_path: Path) -> None:
    """Each recording is an episode with its task, its id and its results, and the state names channels and units."""
    made = [public(number) for number in range(5)]
    local.put_many(made)
    found = exported(local, tmp_path / "given", fps=50)
    assert [each.row["recording"] for each in found.episodes] == [str(each.id) for each in made]
    assert [each.task for each in found.episodes] == [f"squeezing object{number % 3}" for number in range(5)]
    assert json.loads(found.episodes[2].row["results_json"])[0]["value"] == 42.0
    assert found.info["fps"] == 50
    assert found.info["robot_type"] == "two_finger"
    assert found.info["features"]["observation.state"]["names"] == [
        "two_finger.position [mm]",
        "two_finger.current [A]",
        "two_finger.force.0 [N]",
        "two_finger.force.1 [N]",
        "two_finger.force.2 [N]",
    ]


@pytest.mark.parametrize(("rule", "at_half"), [(Nearest(), 0.0), (Linear(), 0.05)])
def test_the_state_is_resampled(local: Store, tmp_path: Path, rule: Any, at_half: float) -> None:
    """At the rate of the samples they stay; between two of them the rule says what there is."""
    local.put(moved(ramp("clock", 11, rate_hz=10.0)))
    same = exported(local, tmp_path / "same", fps=10, resampling=rule).episodes[0].values("observation.state")
    np.testing.assert_allclose(same, np.arange(11) / 10, rtol=1e-6)
    double = exported(local, tmp_path / "double", fps=20, resampling=rule).episodes[0].values("observation.state")
    assert len(double) == 21
    assert double[1] == pytest.approx(at_half)


def test_an_episode_lasts_while_all_channels_do(local: Store, tmp_path: Path) -> None:
    """Frames begin when the last channel has begun and end with the first; what is not finite is passed over."""
    late = Channel("late", "time", "s", np.array([0.2, np.nan, 0.4, 0.5]), time_s=np.array([0.2, 0.3, 0.4, 0.5]))
    mixed = Channel("mixed", "time", "s", np.array([0.9, 0.0, 0.3]), time_s=np.array([0.9, 0.0, 0.3]))
    local.put(moved(ramp("clock", 11, rate_hz=10.0), late, mixed))
    state = exported(local, tmp_path / "given", fps=10, resampling=Linear()).episodes[0].values("observation.state")
    np.testing.assert_allclose(state, np.array([[0.2, 0.3, 0.4, 0.5]] * 3).T, rtol=1e-6)


def test_channels_without_times(local: Store, tmp_path: Path) -> None:
    """A channel of which nobody knows when it was is left out, unless a rate is assumed, which is told."""
    local.put(moved(ramp("clock", 11, rate_hz=10.0), ramp("untimed", 6)))
    told = written(local, LeRobot(TERMS), tmp_path / "without")
    assert "robot.untimed: left out, without a rate or time stamps in 1" in told.notices[0]
    assert read(tmp_path / "without").info["features"]["observation.state"]["shape"] == [1]
    state = exported(local, tmp_path / "with", fps=10, assumed_rate_hz=5.0).episodes[0].values("observation.state")
    np.testing.assert_allclose(state[:, 1], Nearest()(np.arange(11) / 10, np.arange(6) / 5, state[:6, :1])[:, 0])
    assert "5 Hz is assumed" in (tmp_path / "with" / "README.md").read_text(encoding="utf-8")


def test_what_not_all_have_is_left_out(local: Store, tmp_path: Path) -> None:
    """A channel that some recordings lack is no part of the state, and it is told in how many it is."""
    both, one = moved(ramp("a", 3, rate_hz=10.0), ramp("b", 3, rate_hz=10.0)), moved(ramp("a", 3, rate_hz=5.0))
    local.put_many([both, one])
    told = written(local, LeRobot(TERMS), tmp_path / "given")
    assert told.notices == ("robot.b (s): left out, only 1 of 2 recordings have it",)
    assert read(tmp_path / "given").info["features"]["observation.state"]["names"] == ["robot.a [s]"]


def test_recordings_of_several_kinds_are_refused(local: Store, tmp_path: Path) -> None:
    """Where nothing is in all recordings the error says what some have, and that a selection is needed; one helps."""
    other = replace(moved(ramp("x", 3, rate_hz=10.0)), action="moving")
    local.put_many([public(1), other, public(2, series=())])
    with pytest.raises(StoreError, match=r"no image that all recordings have \(.*only 1 of 2 .*\), expected"):
        written(local, LeRobot(TERMS), tmp_path / "given")
    told = written(local, LeRobot(TERMS), tmp_path / "given", Filter(action="squeezing"))
    assert told.recordings == 1
    assert told.notices[0].startswith("1 recording left out, two_finger.position is not in it")
    assert read(tmp_path / "given").info["total_tasks"] == 1


def test_an_image_that_breaks_off_is_told(local: Store, tmp_path: Path) -> None:
    """A recording whose image begins well and cannot be read to its end is no episode, and nothing of it is written."""
    for number, image in enumerate((png(1), png(2)[:-30])):
        local.put(public(number, files=(FileItem("cam0.png", "image/png", image),)))
    told = written(local, LeRobot(TERMS), tmp_path / "given")
    assert told.notices[0].startswith("1 recording left out, the image cam0.png cannot be read")
    assert len(read(tmp_path / "given").episodes) == 1


def test_images_are_features(local: Store, tmp_path: Path) -> None:
    """An image that all recordings have in one size is in every frame, in red, green and blue."""
    shades = {1: png(10), 2: png(20, mode="L"), 3: png(30, mode="RGBA")}
    for number, image in shades.items():
        files = (FileItem("imgs/cam 0.png", "image/png", image), FileItem("imgs/cam_0.png", "image/png", png(40)))
        local.put(public(number, files=files))
    found = exported(local, tmp_path / "given", fps=10)
    assert found.info["features"]["observation.images.imgs_cam_0"]["shape"] == [6, 8, 3]
    for each, shade in zip(found.episodes, (10, 20, 30), strict=True):
        np.testing.assert_allclose(each.values("observation.images.imgs_cam_0"), shade / 255)
        np.testing.assert_allclose(each.values("observation.images.imgs_cam_0_2"), 40 / 255)
    first = found.episodes[0].frames["observation.images.imgs_cam_0"][0]
    assert first == {"bytes": shades[1], "path": "cam 0.png"}


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (png(1, (5, 5)), "cam0.png: left out, only 1 of 2 recordings have it in 8 x 6"),
        (b"no image", "cam0.png: left out, no image of eight bits in 1"),
        (png(300, mode="I;16"), "cam0.png: left out, no image of eight bits in 1"),
    ],
)
def test_images_that_cannot_be_features(local: Store, tmp_path: Path, other: bytes, message: str) -> None:
    """Images of another size, of more than eight bits, or that are none, are told and left out."""
    for number, image in enumerate((png(1), other)):
        local.put(public(number, files=(FileItem("cam0.png", "image/png", image),)))
    told = written(local, LeRobot(TERMS), tmp_path / "given")
    assert message in told.notices
    assert not [name for name in read(tmp_path / "given").info["features"] if "images" in name]


def test_images_alone_are_one_frame(local: Store, tmp_path: Path) -> None:
    """A recording that has images and no signals is an episode of one frame, without a state."""
    local.put(public(1, series=(), files=(FileItem("cam0.png", "image/png", png(1)),)))
    found = exported(local, tmp_path / "given")
    assert found.info["total_frames"] == 1
    assert "observation.state" not in found.info["features"]


def test_a_large_image_is_written_once_for_an_episode(local: Store, tmp_path: Path) -> None:
    """An image in hundreds of frames takes hardly more than its own size."""
    noise = np.random.default_rng(0).integers(0, 256, (100, 100, 3), dtype=np.uint8)
    from io import BytesIO

    from PIL import Image

    encoded = BytesIO()
    Image.fromarray(noise).save(encoded, "PNG")
    item = FileItem("cam0.png", "image/png", encoded.getvalue())
    local.put(replace(moved(ramp("clock", 21, rate_hz=10.0)), files=(item,)))
    exported(local, tmp_path / "given", fps=50)
    size = sum(path.stat().st_size for path in (tmp_path / "given" / "data").rglob("*.parquet"))
    assert size < 3 * len(encoded.getvalue())


def test_many_files(local: Store, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where files are full others follow, in folders of so many, and the numbers lead to them."""
    from palpate.store.exporting.lerobot import episodes, info

    monkeypatch.setattr(shards, "GROUP_ROWS", 1)
    monkeypatch.setattr(episodes, "ROWS_AT_ONCE", 2)
    for module in (episodes, info):
        monkeypatch.setattr(module, "CHUNK_FILES", 2)
    local.put_many([public(number) for number in range(5)])
    found = exported(local, tmp_path / "given", data_mb=0)
    where = [(each.row["data/chunk_index"], each.row["data/file_index"]) for each in found.episodes]
    assert where == [(0, 0), (0, 1), (1, 0), (1, 1), (2, 0)]
    where = [(each.row["meta/episodes/chunk_index"], each.row["meta/episodes/file_index"]) for each in found.episodes]
    assert where == [(0, 0), (0, 0), (0, 1), (0, 1), (1, 0)]


@pytest.mark.parametrize(
    ("channels", "message"),
    [
        ((Channel("x", "x", None, np.array([np.nan, np.inf]), rate_hz=1.0),), "a channel has no finite samples"),
        ((ramp("a", 3, rate_hz=10.0), ramp("b", 2, time_s=np.array([5.0, 6.0]))), "no moment in common"),
        ((ramp("a", 2, time_s=np.array([0.0, 1e9])),), "frames, expected at most 1000000"),
        ((Channel("x", "x", None, np.array([1e300]), rate_hz=1.0),), "a channel has no finite samples"),
    ],
)
def test_what_cannot_be_an_episode(local: Store, tmp_path: Path, channels: tuple[Channel, ...], message: str) -> None:
    """A recording without a moment at which all channels are known is told, and is the end where it is the only one."""
    local.put(moved(*channels))
    with pytest.raises(StoreError, match=rf"no recording can be an episode \(1 recording left out, .*{message}"):
        written(local, LeRobot(TERMS), tmp_path / "given")
    local.put(
        replace(public(7), series=(Series("robot", tuple(ramp(each.name, 5, rate_hz=10.0) for each in channels)),))
    )
    units = {each.unit for each in channels}
    if units == {"s"}:
        told = written(local, LeRobot(TERMS), tmp_path / "given")
        assert told.recordings == 1
        assert message in told.notices[-1]


def test_the_card_says_what_was_done(local: Store, tmp_path: Path) -> None:
    """The card names the layout for the Hub, the rule, and what was left out."""
    local.put_many([public(1), public(2, files=(FileItem("a.png", "image/png", png(1)),))])
    written(local, LeRobot(TERMS, fps=20, resampling=Linear()), tmp_path / "given")
    text = (tmp_path / "given" / "README.md").read_text(encoding="utf-8")
    plain = yaml.safe_load(text.split("---\n")[1])
    assert "LeRobot" in plain["tags"]
    assert plain["configs"][0]["data_files"] == [{"split": "train", "path": "data/*/*.parquet"}]
    assert "2 episodes" in text
    assert "at 20 frames per second" in text
    assert "interpolated linearly" in text
    assert "- a.png: left out, only 1 of 2 recordings" in text


times = st.lists(st.integers(0, 64), min_size=1, max_size=6, unique=True).map(lambda each: np.sort(each) / 32)


@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow])
@given(stamps=st.lists(times, min_size=1, max_size=3), fps=st.sampled_from([1, 16, 64]))
def test_how_many_frames_there_are(
    tmp_path_factory: pytest.TempPathFactory, stamps: list[np.ndarray], fps: int
) -> None:
    """There is a frame at each step from the latest first sample to the earliest last one, and none elsewhere."""
    start, end = max(each[0] for each in stamps), min(each[-1] for each in stamps)
    expected = [start + step / fps for step in range(200) if start + step / fps <= end]
    folder = tmp_path_factory.mktemp("frames")
    with open_store(folder / "store.sqlite", durable=False) as store:
        store.put(moved(*(Channel(f"c{number}", "time", "s", each, time_s=each) for number, each in enumerate(stamps))))
        if expected:
            state = (
                exported(store, folder / "given", fps=fps, resampling=Linear()).episodes[0].values("observation.state")
            )
            np.testing.assert_allclose(state.reshape(len(expected), -1).T, [expected] * len(stamps), rtol=1e-6)
        else:
            with pytest.raises(StoreError, match="no moment in common"):
                written(store, LeRobot(TERMS), folder / "given")
    shutil.rmtree(folder)


@settings(max_examples=25, suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much])
@given(made=recordings(), fps=st.integers(1, 100), rule=st.sampled_from([Nearest(), Linear()]))
def test_any_recording_keeps_the_promises(
    tmp_path_factory: pytest.TempPathFactory, made: Recording, fps: int, rule: Any
) -> None:
    """Whatever was recorded is a data set that keeps all that the layout promises, or an error in one sentence."""
    assume(made.series)
    folder = tmp_path_factory.mktemp("any")
    with pytest.MonkeyPatch.context() as patch, open_store(folder / "store.sqlite", durable=False) as store:
        patch.setattr(frames, "MOST_FRAMES", 1000)
        store.put(made)
        form = LeRobot(TERMS, fps=fps, resampling=rule, assumed_rate_hz=10.0)
        with suppress(StoreError):
            written(store, form, folder / "given")
            assert len(read(folder / "given").episodes) == 1
    shutil.rmtree(folder)
