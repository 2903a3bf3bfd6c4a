"""Made-up things and their pictures: of every category and material, and drawn as the bench draws its own."""

import numpy as np
import pytest

from palpate.network.properties import CategoricalProperty
from palpate.network.reading import load_network
from palpate.robots.mujoco.bench import Bench
from palpate.robots.mujoco.looking import look
from palpate.robots.mujoco.noise import QUIET
from palpate.robots.mujoco.reading import bench_object
from palpate.robots.mujoco.training.gallery import Gallery, Sight, draw_sight
from palpate.robots.mujoco.training.outlines import CATEGORIES
from palpate.robots.mujoco.training.pictures import SIZE, draw_sights, photograph
from palpate.robots.mujoco.training.surfaces import ALL, MATERIALS, SEEN, UNSEEN


def test_all_that_the_network_knows_can_be_drawn() -> None:
    """Outlines and surfaces are those of the household's categories and materials."""
    network = load_network("household")
    for name, drawn in (("category", CATEGORIES), ("material", MATERIALS)):
        known = network.properties[name]
        assert isinstance(known, CategoricalProperty)
        assert set(drawn) == set(known.states)


@pytest.mark.parametrize("names", [("ceramic_mug", "white_tile", "wineglass")])
def test_a_gallery_shows_what_the_bench_sees(names: tuple[str, ...], drawing: None) -> None:
    """One of the bench's own objects in a gallery looks as it does on the bench, whatever else is in the gallery."""
    network = load_network("household")
    things = [bench_object(network, name) for name in names]
    sights = [
        Sight(it.name, "", "", it.parts, it.size_mm[2], (it.size_mm[0], it.size_mm[1]) if it.rack else None)
        for it in things
    ]
    with Gallery(sights) as gallery:
        for number, thing in enumerate(things):
            with Bench(thing, QUIET, np.random.default_rng(0)) as bench:
                wanted = look(bench).image.astype(int)
            assert np.mean(np.abs(gallery.image(number).astype(int) - wanted).max(axis=2) > 8) < 0.001


def test_things_are_drawn_again_by_their_seed(drawing: None) -> None:
    """The same seed gives the same things and pictures; two views of a thing differ."""
    network = load_network("household")
    albums = []
    for _ in range(2):
        rng = np.random.default_rng(5)
        albums.append(photograph(draw_sights(network, 10, ALL, rng, "thing"), 2, rng))
    one, other = albums
    np.testing.assert_array_equal(one.images, other.images)
    assert one.images.shape == (20, SIZE[1], SIZE[0], 3)
    assert one.things.tolist() == [number // 2 for number in range(20)]
    assert not np.array_equal(one.images[0], one.images[1])
    assert [sight.category for sight in one.sights] == list(CATEGORIES)
    examples = one.by([sight.category for sight in one.sights])
    assert examples.labels[:3].tolist() == ["bottle", "bottle", "bowl"]


@pytest.mark.parametrize("category", list(CATEGORIES))
def test_every_drawn_thing_stands_in_the_picture(category: str, drawing: None) -> None:
    """Things of each category are seen in the middle and nowhere near the upper or lower edge."""
    rng = np.random.default_rng(6)
    sights = [draw_sight(f"{category}{n}", category, "soft-plastic", ALL, rng) for n in range(2)]
    with Gallery([*sights, Sight("nothing", "", "", (), 1.0)], (320, 240)) as gallery:
        empty = gallery.image(2).astype(int)
        for number in range(2):
            seen = np.abs(gallery.image(number).astype(int) - empty).max(axis=2) > 24
            rows, columns = np.nonzero(seen)
            assert seen.mean() > 0.002
            assert rows.min() > 4
            assert rows.max() < 230
            assert 80 < columns.mean() < 240


def test_colours_that_are_kept_for_the_test_are_not_in_the_training() -> None:
    """No hue is in both sets."""
    rng = np.random.default_rng(7)
    (low, high), *_ = UNSEEN.arcs
    assert all(low <= UNSEEN.draw(rng) <= high for _ in range(200))
    assert not [hue for hue in (SEEN.draw(rng) for _ in range(500)) if low < hue < high]
