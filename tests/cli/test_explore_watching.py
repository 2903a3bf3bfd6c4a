import subprocess
import sys
from collections import Counter
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

# asked without importing it: the bench says what MuJoCo draws with before it is imported
if find_spec("mujoco") is None:
    pytest.skip("the bench needs MuJoCo", allow_module_level=True)

from palpate.cli.filming import SIZE
from palpate.figures import film
from palpate.outcomes import Label

pytestmark = pytest.mark.usefixtures("drawing")

BENCH = ("--robot", "mujoco", "--seed", 1, "--policy", "fixed:squeezing", "--steps", 1)


WIDTH, HEIGHT = (side // 4 for side in SIZE)


def pictures(path: Path) -> np.ndarray:
    """All pictures of a video, four times smaller, (n, height, width, 3)."""
    import imageio_ffmpeg

    scaled = ("-vf", f"scale={WIDTH}:{HEIGHT}", "-f", "rawvideo", "-pix_fmt", "rgb24", "-")
    read = subprocess.run(
        [imageio_ffmpeg.get_ffmpeg_exe(), "-v", "error", "-i", str(path), *scaled], capture_output=True, check=True
    )
    return np.frombuffer(read.stdout, np.uint8).reshape(-1, HEIGHT, WIDTH, 3)


def test_a_video_shows_the_scene_and_the_belief(run: Any, tmp_path: Path) -> None:
    """The arm has moved on the left, and the belief has changed on the right, on white."""
    pytest.importorskip("imageio_ffmpeg", reason="videos need the extra video")
    path = tmp_path / "episode.mp4"
    ran = run("explore", "soft_yellow_sponge", *BENCH, "--video", path)
    assert ran.code == 0, ran.err
    found = pictures(path)
    assert len(found) > 3 * film.RATE_HZ
    first, last = found[0], found[-1]
    scene, panel = np.s_[:, :240], np.s_[:, 240:]
    for part in (scene, panel):
        assert np.abs(first[part].astype(int) - last[part]).max() > 100
    assert np.median(last[panel]) > 250
    assert list(tmp_path.glob(".*")) == []


def test_a_video_shows_what_the_camera_saw(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The image stands in a corner, in a white frame, when it was looked at."""
    pytest.importorskip("imageio_ffmpeg", reason="videos need the extra video")
    looks = {"cat-vision": lambda signals: Label("mug")}
    monkeypatch.setattr("palpate.robots.mujoco.estimates.estimates", lambda network: looks)
    path = tmp_path / "episode.mp4"
    assert run("explore", "banana_ycb", "--robot", "mujoco", "--seed", 1, "--video", path).code == 0
    found = pictures(path)
    frame = found[:, -42, :53]  # the upper edge of the camera's image
    assert frame[0].min() < 200
    assert frame[-1].min() > 200


def test_a_video_that_is_cut_off_is_not_kept(run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An exploration that breaks leaves no half of a video, and what was there before stays."""
    pytest.importorskip("imageio_ffmpeg", reason="videos need the extra video")
    path = tmp_path / "episode.mp4"
    path.write_text("what was there before", encoding="utf-8")
    monkeypatch.setattr(sys.modules["palpate.cli.exploring"], "_explore", lambda *_: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        run("explore", "banana", *BENCH, "--video", path)
    assert [one.name for one in tmp_path.iterdir()] == ["episode.mp4"]
    assert path.read_text(encoding="utf-8") == "what was there before"


def test_a_log_for_rerun_holds_beliefs_images_and_signals(run: Any, tmp_path: Path) -> None:
    """Each state has its probability at each step, each signal its samples, and the scene its pictures."""
    chunk = pytest.importorskip("rerun.chunk", reason="logs for Rerun need the extra rerun")
    path = tmp_path / "episode.rrd"
    ran = run("explore", "soft_yellow_sponge", *BENCH, "--rerun", path)
    assert ran.code == 0, ran.err
    assert len(chunk.RrdReader(path).blueprints()) == 1
    rows: Counter[str] = Counter()
    held: dict[str, str] = {}
    for one in chunk.RrdReader(path).stream():
        rows[one.entity_path] += one.num_rows
        held[one.entity_path] = str(one.to_record_batch().schema)
    # a bar without a width is one unit wide, and not seen where bars are far apart
    assert "BarChart:widths" in held["/belief/density"]
    # the prior, the step, and the end
    assert rows["/belief/material/foam"] == rows["/belief/elasticity"] == 3
    assert rows["/gains/squeezing"] == 1
    assert rows["/signals/gripper/force_n"] > 30
    assert rows["/scene"] > 10
    assert rows["/words"] == 3


@dataclass
class Window:
    """Stands for a window of MuJoCo's."""

    running: bool = True
    shown: int = 0
    is_closed: bool = False
    cam: Any = field(default_factory=lambda: SimpleNamespace(lookat=np.zeros(3)))
    opt: SimpleNamespace = field(default_factory=lambda: SimpleNamespace(geomgroup=[1] * 6))

    def is_running(self) -> bool:
        return self.running

    def sync(self) -> None:
        self.shown += 1

    def close(self) -> None:
        self.is_closed = True


def test_the_viewer_shows_what_happens(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each hundredth of a second is shown, as fast as it passes; closing the window ends nothing."""
    from palpate.robots.mujoco import viewer

    window, waited = Window(), list[float]()
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("mujoco.viewer.launch_passive", lambda *_, **__: window)
    monkeypatch.setattr(viewer, "sleep", waited.append)
    monkeypatch.setattr(viewer, "monotonic", lambda: sum(waited))
    assert run("explore", "banana", *BENCH, "--viewer").code == 0
    assert window.is_closed
    assert window.shown > 200
    assert sum(waited) == pytest.approx(window.shown * 0.01, rel=0.02)
    closed = Window(running=False)
    monkeypatch.setattr("mujoco.viewer.launch_passive", lambda *_, **__: closed)
    assert run("explore", "banana", *BENCH, "--viewer").code == 0
    assert closed.shown == 0


def test_without_a_screen_there_is_no_viewer(run: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """No screen, or a window that does not open, is one sentence."""
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(sys, "platform", "linux")
    assert "the viewer needs a screen" in run("explore", "banana", *BENCH, "--viewer").refused

    def broken(*_: object, **__: object) -> None:
        raise RuntimeError("no GLFW")

    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr("mujoco.viewer.launch_passive", broken)
    assert "the viewer cannot open a window (no GLFW)" in run("explore", "banana", *BENCH, "--viewer").refused


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("--video", "episode.avi", *BENCH), "--video: episode.avi was found, expected a name that ends in .mp4"),
        (("--rerun", "episode.mp4", *BENCH), "--rerun: episode.mp4 was found, expected a name that ends in .rrd"),
        (("--video", "nowhere/episode.mp4", *BENCH), "--video: the folder nowhere does not exist"),
        (("--video", "episode.mp4"), "--video is only for --robot mujoco, and the robot is sampled"),
        (("--viewer",), "--viewer is only for --robot mujoco, and the robot is sampled"),
    ],
)
def test_what_cannot_be_watched_is_refused(run: Any, arguments: tuple[object, ...], told: str) -> None:
    """Bad input is refused before anything moves."""
    assert told in run("explore", "banana", *arguments).refused


@pytest.mark.parametrize(
    ("module", "option", "name"),
    [("palpate.figures.film", "--video", "video"), ("palpate.cli.rerunning", "--rerun", "rerun")],
)
def test_missing_packages_are_named(
    run: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, module: str, option: str, name: str
) -> None:
    """Without its package an option says what to install."""
    monkeypatch.setattr(f"{module}.find_spec", lambda _: None)
    file = tmp_path / {"--video": "episode.mp4", "--rerun": "episode.rrd"}[option]
    assert f'pip install "palpate[{name}]"' in run("explore", "banana", *BENCH, option, file).refused


def test_the_window_shows_what_the_film_shows() -> None:
    """Its camera, which a mouse can move, begins where the camera of the whole scene is, and looks the same way."""
    from palpate.robots.mujoco.furniture import OVERVIEW
    from palpate.robots.mujoco.scene import Scene
    from palpate.robots.mujoco.viewer import look_as

    import mujoco  # isort: skip

    scene, free = Scene(None), mujoco.MjvCamera()
    look_as(free, scene)
    drawn, placed = mujoco.MjvScene(scene.model, 1000), scene.data.camera(OVERVIEW)
    mujoco.mjv_updateScene(
        scene.model, scene.data, mujoco.MjvOption(), None, free, mujoco.mjtCatBit.mjCAT_ALL.value, drawn
    )
    seen = drawn.camera[0]
    np.testing.assert_allclose(seen.pos, placed.xpos, atol=0.05)
    np.testing.assert_allclose(seen.forward, -placed.xmat.reshape(3, 3)[:, 2], atol=1e-5)
