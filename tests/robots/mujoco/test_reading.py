import re
from pathlib import Path

import pytest

from palpate.errors import EvidenceError
from palpate.network.reading import load_network
from palpate.robots.mujoco.errors import BenchError
from palpate.robots.mujoco.reading import SHIPPED, bench_object
from palpate.robots.mujoco.scene import Scene

NETWORK = load_network("household")
TEXT = SHIPPED.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", NETWORK.objects)
def test_each_shipped_object_stands_on_the_bench(name: str) -> None:
    """Each object of the shipped network has shape, mass and stiffness, and rests on the table where it was put."""
    thing = bench_object(NETWORK, name)
    assert thing.mass_g == NETWORK.object(name).truth["mass"].value
    assert thing.elasticity_kpa == NETWORK.object(name).truth["elasticity"].value
    scene = Scene(thing)
    start = scene.data.body("object").xpos.copy()
    scene.step(250)
    moved = scene.data.body("object").xpos - start
    assert abs(moved).max() < 1e-3
    assert thing.parts


def test_a_trick_looks_like_what_it_imitates() -> None:
    """An object without an entry has the shape of its look-alike, and its own mass and stiffness."""
    fake, real = bench_object(NETWORK, "banana_ycb"), bench_object(NETWORK, "banana")
    assert fake.parts == real.parts
    assert (fake.mass_g, fake.elasticity_kpa) != (real.mass_g, real.elasticity_kpa)
    assert fake.substance != real.substance


def changed(tmp_path: Path, old: str, new: str) -> Path:
    assert old in TEXT
    path = tmp_path / "things.toml"
    path.write_text(TEXT.replace(old, new), encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("palpate-bench/1", "palpate-bench/9", "format 'palpate-bench/9' was found, expected 'palpate-bench/1'"),
        ("objects.banana", "objects.melon", "no shape of object 'banana' was found"),
        ("[substances.foam]", "[substances.cork]", "no substance 'foam' was found"),
        ("size_mm = [190, 36, 64]", "size_mn = [190, 36, 64]", r"unknown key 'size_mn' \(did you mean 'size_mm'\?\)"),
        ("size_mm = [190, 36, 64]", "", "object 'banana': .*'size_mm'"),
        ('mass = "mass"', 'mass = "weight"', "mass = 'weight' was found, expected one that network 'household' has"),
        ('mass = "mass"', 'mass = "volume"', "mass = 'volume': unit 'cm.3' is"),
        ('mass = "mass"', 'mass = "material"', "mass = 'material' was found, expected a property that is a number"),
        ('look = "banana"', 'look = "bananna"', "no look 'bananna' was found"),
        ('kind = "tube"\nlook = "banana"', 'look = "banana"', "a part of object 'banana' lacks 'kind'"),
    ],
)
def test_mistakes_in_a_file_are_one_sentence(tmp_path: Path, old: str, new: str, told: str) -> None:
    """What is wrong in a file is named with its place and what would be right."""
    with pytest.raises(BenchError, match=told) as caught:
        bench_object(NETWORK, "banana", changed(tmp_path, old, new))
    assert re.match(r".*things\.toml: ", str(caught.value))


def test_files_that_cannot_be_read_are_named(tmp_path: Path) -> None:
    """A missing file and one that is no TOML are errors of the bench; an unknown object is one of the network."""
    with pytest.raises(BenchError, match=r"none\.toml cannot be read"):
        bench_object(NETWORK, "banana", tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("objects = [", encoding="utf-8")
    with pytest.raises(BenchError, match=r"bad\.toml cannot be read as TOML"):
        bench_object(NETWORK, "banana", tmp_path / "bad.toml")
    with pytest.raises(EvidenceError, match="unknown object 'bannana'"):
        bench_object(NETWORK, "bannana")
