import mujoco
import numpy as np
import pytest

from palpate.network.reading import load_network
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.camera import Camera
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.looking import look
from palpate.robots.mujoco.noise import QUIET, BenchNoise
from palpate.robots.mujoco.reading import bench_object
from palpate.robots.mujoco.scene import Scene


def differing(image, other) -> float:
    """Share of pixels that clearly differ."""
    return float(np.mean(np.abs(image.astype(int) - other.astype(int)).max(axis=2) > 24))


def test_the_object_is_in_the_picture(bench, drawing) -> None:
    """Without the object a share of the pixels differs, around the middle; elsewhere nothing does."""
    with bench() as made, Camera(empty := Scene(None)) as camera:
        image = look(made).image
        empty.home_rad = made.scene.home_rad
        empty.reset()
        without = camera.image()
    assert image.shape == (480, 640, 3)
    assert image.dtype == np.uint8
    assert 0.01 < differing(image, without) < 0.2
    rows, columns = np.nonzero(np.abs(image.astype(int) - without.astype(int)).max(axis=2) > 24)
    assert 120 < rows.mean() < 360
    assert 200 < columns.mean() < 440
    assert differing(image[:60], without[:60]) == 0


def test_colours_are_those_of_the_look(bench, drawing) -> None:
    """A red block looks red in the middle of the picture."""
    with bench() as made:
        image = look(made).image
    middle = image[230:260, 300:340].reshape(-1, 3).mean(axis=0)
    assert middle[0] > 2 * middle[1]
    assert middle[0] > 2 * middle[2]


@pytest.mark.parametrize("name", ["banana", "wineglass", "white_tile"])
def test_shipped_objects_are_seen(name: str, drawing) -> None:
    """Shipped objects of meshes, of glass and in a rack stand out from the empty table."""
    thing = bench_object(load_network("household"), name)
    with Bench(thing, QUIET, np.random.default_rng(0)) as made, Camera(empty := Scene(None)) as camera:
        image = look(made).image
        empty.home_rad = made.scene.home_rad
        empty.reset()
        assert differing(image, camera.image()) > 0.003


def test_the_seed_decides_the_picture(bench, drawing) -> None:
    """The same seed gives the same picture; each look puts the object down anew."""
    images = []
    for seed in (1, 1):
        with bench(BenchNoise(), seed=seed) as made:
            images.append((look(made).image, look(made).image))
    np.testing.assert_array_equal(images[0][0], images[1][0])
    assert differing(images[0][0], images[0][1]) > 0


def test_lamps_are_as_before_after_a_look(bench, drawing) -> None:
    """Brightness is changed for the picture only."""
    with bench(BenchNoise()) as made:
        before = made.scene.model.light_diffuse.copy()
        look(made)
        np.testing.assert_array_equal(made.scene.model.light_diffuse, before)


def test_where_nothing_can_be_drawn_the_error_says_what_to_do(monkeypatch) -> None:
    """A machine without graphics gives one sentence with the variable to set."""

    def fail(*_: object) -> None:
        raise mujoco.FatalError("no context")

    monkeypatch.setattr(mujoco, "Renderer", fail)
    with Camera(Scene(None)) as camera, pytest.raises(BenchError, match="install Mesa's EGL or OSMesa"):
        camera.image()


def test_a_camera_may_be_closed_twice(drawing) -> None:
    """Closing again does nothing, and a closed camera draws again when asked."""
    camera = Camera(Scene(None), (64, 48))
    first = camera.image()
    camera.close()
    camera.close()
    np.testing.assert_array_equal(camera.image(), first)
    camera.close()
