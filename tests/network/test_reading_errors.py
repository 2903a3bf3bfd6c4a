"""Bad network files: one sentence with the file, the key, what was found and what would be right."""

from pathlib import Path

import pytest

from palpate.errors import NetworkError
from palpate.network.reading import load_network

BASE = """
[properties.category]
states = ["mug", "box"]
[properties.material]
states = ["metal", "paper"]
parents = ["category"]
[properties.material.given]
mug = [1, 0]
box = [0, 1]
[properties.volume]
unit = "cm^3"
family = "truncated-normal"
low = 0
parents = ["category"]
[properties.volume.given]
mug = {mean = 90, sd = 30}
box = {mean = 20, sd = 10}
[properties.density]
unit = "kg/m^3"
family = "uniform"
low = 1
high = 2
[properties.mass]
unit = "g"
formula = "density * volume"
[actions.look]
cost_s = 1
[actions.look.sensor]
property = "category"
kind = "confusion"
[actions.look.sensor.given]
mug = [0.9, 0.1]
box = [0.1, 0.9]
[actions.weigh]
cost_s = 15
[actions.weigh.sensor]
property = "mass"
kind = "normal"
sd = 6
[objects.tin]
[objects.tin.truth]
category = "mug"
material = "metal"
volume = 90
density = 1.5
"""

# (what to replace, by what, key in the message, parts of the message)
CASES = {
    "unknown top key": (
        "[properties.category]",
        'author = "x"\n[properties.category]',
        "author",
        ["unknown key 'author'", "choose from"],
    ),
    "misspelt key": ("low = 0", "lo = 0", "properties.volume.lo", ["did you mean 'low'?"]),
    "sum": ("mug = [1, 0]", "mug = [0.9, 0]", "properties.material.given.mug", ["sum to 0.9", "a sum of 1"]),
    "too few": (
        "mug = [1, 0]",
        "mug = [1]",
        "properties.material.given.mug",
        ["found 1 probabilities; expected 2, for metal, paper"],
    ),
    "negative": ("mug = [1, 0]", "mug = [1.5, -0.5]", "properties.material.given.mug", ["found -0.5"]),
    "nan": ("mug = [1, 0]", "mug = [nan, 0]", "properties.material.given.mug", ["found nan"]),
    "infinity": ("sd = 30", "sd = inf", "properties.volume.given.mug.sd", ["found inf; expected a finite number"]),
    "a number too large for a float": (
        "sd = 30",
        f"sd = 1{'0' * 400}",
        "properties.volume.given.mug.sd",
        ["expected a finite number"],
    ),
    "truth that gives no number": (
        'formula = "density * volume"',
        'formula = "density * volume / log(density / density)"',
        "objects.tin.truth",
        ["= inf; expected a finite number"],
    ),
    "a number added to a quantity": (
        'formula = "density * volume"',
        'formula = "density * volume / (density - 1.5)"',
        "properties.mass.formula",
        ["adds length^-3 mass and a number without a unit"],
    ),
    "text for a number": (
        "sd = 30",
        'sd = "30"',
        "properties.volume.given.mug.sd",
        ["found '30'; expected a finite number"],
    ),
    "true for a number": ("sd = 30", "sd = true", "properties.volume.given.mug.sd", ["found True"]),
    "negative sd": ("sd = 30", "sd = -30", "properties.volume.given.mug.sd", ["found -30; expected a number above 0"]),
    "missing parameter": (", sd = 30", "", "properties.volume.given.mug", ["found no 'sd'; expected a number"]),
    "unknown state in given": (
        "box = [0, 1]",
        "bix = [0, 1]",
        "properties.material.given.bix",
        ["did you mean 'box'?", "choose from 'mug', 'box'"],
    ),
    "missing state in given": ("box = [0, 1]", "", "properties.material.given", ["found no 'box'"]),
    "unknown state in a table": (
        "mug = [1, 0]",
        "mug = {metall = 1}",
        "properties.material.given.mug.metall",
        ["did you mean 'metal'?"],
    ),
    "unknown parent": (
        'parents = ["category"]\n[properties.m',
        'parents = ["categori"]\n[properties.m',
        "properties.material.parents",
        ["did you mean 'category'?"],
    ),
    "parent with numbers": (
        'parents = ["category"]\n[properties.m',
        'parents = ["density"]\n[properties.m',
        "properties.material.parents",
        ["'density', which is not categorical", "choose from 'category', 'material'"],
    ),
    "cycle": (
        'states = ["mug", "box"]',
        'states = ["mug", "box"]\nparents = ["material"]',
        "properties.category.parents",
        ["the cycle category -> material -> category"],
    ),
    "prior with parents": (
        'states = ["metal", "paper"]',
        'states = ["metal", "paper"]\nprior = [1, 0]',
        "properties.material.prior",
        ["expected 'given'"],
    ),
    "duplicate states": (
        'states = ["mug", "box"]',
        'states = ["mug", "mug"]',
        "properties.category.states",
        ["found 'mug' 2 times"],
    ),
    "no states": ('states = ["mug", "box"]', "states = []", "properties.category.states", ["expected at least one"]),
    "states of numbers": (
        'states = ["mug", "box"]',
        "states = [1, 2]",
        "properties.category.states",
        ["expected a list of names"],
    ),
    "high below low": (
        "high = 2",
        "high = 0.5",
        "properties.density.high",
        ["found low 1 and high 0.5; expected low below high"],
    ),
    "no truncation": ("low = 0", "", "properties.volume.given.mug", ["neither 'low' nor 'high'"]),
    "unknown family": ('"uniform"', '"unifrom"', "properties.density.family", ["did you mean 'uniform'?"]),
    "no kind of property": (
        'family = "uniform"\n',
        "",
        "properties.density",
        ["neither 'states' nor 'family' nor 'formula'"],
    ),
    "unknown unit": ('"kg/m^3"', '"kg/m3"', "properties.density.unit", ["unknown unit 'kg/m3'"]),
    "wrong dimension": (
        'unit = "g"',
        'unit = "kPa"',
        "properties.mass.formula",
        ["gives mass; expected length^-1 mass time^-2, as unit 'kPa'"],
    ),
    "unknown in formula": (
        "density * volume",
        "density * volme",
        "properties.mass.formula",
        ["did you mean 'volume'?"],
    ),
    "state in formula": (
        "density * volume",
        "density * category",
        "properties.mass.formula",
        ["unknown property 'category'"],
    ),
    "formula of nothing": (
        "density * volume",
        "3 * 4",
        "properties.mass.formula",
        ["expected a formula over properties"],
    ),
    "formula syntax": ("density * volume", "density *", "properties.mass.formula", ["cannot be read"]),
    "formula that cannot be inverted": (
        "density * volume",
        "density * volume + density * volume",
        "properties.mass.formula",
        ["each of density, volume occurs more than once"],
    ),
    "formula of itself": (
        "density * volume",
        "density * volume + mass",
        "properties.mass.formula",
        ["the cycle mass -> mass"],
    ),
    "reserved name": (
        "[properties.density]",
        "[properties.everything]",
        "properties.everything",
        ["the reserved name 'everything'"],
    ),
    "negative cost": ("cost_s = 15", "cost_s = -1", "actions.weigh.cost_s", ["found -1"]),
    "no cost": ("cost_s = 15", "", "actions.weigh", ["found no 'cost_s'"]),
    "no sensor": (
        "[actions.weigh.sensor]",
        "[actions.weigh.sensors]",
        "actions.weigh.sensors",
        ["did you mean 'sensor'?"],
    ),
    "sensor of nothing": (
        'property = "mass"',
        'property = "mas"',
        "actions.weigh.sensor.property",
        ["did you mean 'mass'?"],
    ),
    "unknown kind": (
        'kind = "normal"',
        'kind = "gauss"',
        "actions.weigh.sensor.kind",
        ["choose from 'confusion', 'normal', 'student-t'"],
    ),
    "kind for a number": (
        'kind = "confusion"',
        'kind = "normal"\nsd = 1',
        "actions.look.sensor.given",
        ["unknown key 'given'"],
    ),
    "confusion of a number": (
        'property = "category"\nkind',
        'property = "mass"\nkind',
        "actions.look.sensor.kind",
        ["which is a number; choose from 'normal', 'student-t'"],
    ),
    "no noise": ("sd = 6", "", "actions.weigh.sensor", ["neither 'sd' nor 'relative_sd'"]),
    "no noise at all": ("sd = 6", "sd = 0", "actions.weigh.sensor.sd", ["found 0; expected a number above 0"]),
    "saturation": (
        "sd = 6",
        "sd = 6\nsaturates_below = 5\nsaturates_above = 5",
        "actions.weigh.sensor.saturates_above",
        ["below 5 and above 5"],
    ),
    "offset": ("sd = 6", "sd = 6\noffset_sd = -1", "actions.weigh.sensor.offset_sd", ["found -1"]),
    "repetition": (
        "[actions.look.sensor.given]",
        "repeat_probability = 1.5\n[actions.look.sensor.given]",
        "actions.look.sensor.repeat_probability",
        ["found 1.5; expected a number from 0 to 1"],
    ),
    "confusion sum": ("box = [0.1, 0.9]", "box = [0.1, 0.8]", "actions.look.sensor.given.box", ["sum to 0.9"]),
    "appearance": (
        "cost_s = 15",
        'cost_s = 15\nsees_appearance = "yes"',
        "actions.weigh.sees_appearance",
        ["expected true or false"],
    ),
    "no truth": ("density = 1.5", "", "objects.tin.truth", ["found no 'density'"]),
    "unknown truth": ("density = 1.5", "density = 1.5\nhue = 3", "objects.tin.truth.hue", ["unknown property 'hue'"]),
    "truth outside the states": (
        'material = "metal"',
        'material = "wood"',
        "objects.tin.truth.material",
        ["choose from 'metal', 'paper'"],
    ),
    "number for a state": (
        'material = "metal"',
        "material = 3",
        "objects.tin.truth.material",
        ["found 3; expected a string"],
    ),
    "state for a number": (
        "density = 1.5",
        'density = "heavy"',
        "objects.tin.truth.density",
        ["found 'heavy'; expected a finite number"],
    ),
    "status": (
        "density = 1.5",
        'density = {value = 1.5, status = "guessed"}',
        "objects.tin.truth.density.status",
        ["choose from 'measured', 'assumed', 'unknown'"],
    ),
    "measured without source": (
        "density = 1.5",
        'density = {value = 1.5, status = "measured"}',
        "objects.tin.truth.density.status",
        ["without a source"],
    ),
    "truth against the formula": (
        "density = 1.5",
        "density = 1.5\nmass = 9",
        "objects.tin.truth.mass",
        ["found 9.0, but density * volume is 0.135"],
    ),
    "look-alike": (
        "[objects.tin.truth]",
        'looks_like = "gold"\n[objects.tin.truth]',
        "objects.tin.looks_like",
        ["unknown object 'gold'"],
    ),
    "looks like itself": (
        "[objects.tin.truth]",
        'looks_like = "tin"\n[objects.tin.truth]',
        "objects.tin.looks_like",
        ["found the object itself"],
    ),
    "a value for a table": ("[properties.category]", "actions = 3\n[properties.category]", "actions", []),
}


def refused(path: Path) -> str:
    with pytest.raises(NetworkError) as caught:
        load_network(path)
    return str(caught.value)


def written(folder: Path, text: str, name: str = "bad.toml") -> Path:
    path = folder / name
    path.write_text('format = "palpate-network/1"\n' + text, encoding="utf-8")
    return path


def test_the_base_is_valid(tmp_path: Path) -> None:
    """What the cases spoil is valid itself."""
    assert load_network(written(tmp_path, BASE)).joint_states == 4


@pytest.mark.parametrize("case", CASES)
def test_one_fault_gives_one_clear_sentence(case: str, tmp_path: Path) -> None:
    """The message is one line: file, key, what was found, what would be right."""
    old, new, key, parts = CASES[case]
    assert old in BASE
    base = BASE if case != "a value for a table" else BASE[: BASE.index("[actions.look]")]
    path = written(tmp_path, base.replace(old, new, 1))
    message = refused(path)
    assert message.startswith(f"{path}: {key}: found ")
    assert "\n" not in message
    for part in parts:
        assert part in message


def test_too_many_joint_states_are_refused_with_the_number(tmp_path: Path) -> None:
    """A joint of more than a million states cannot be enumerated; it is refused before any table is read."""
    states = [f"s{i}" for i in range(101)]
    text = "\n".join(f"[properties.p{i}]\nstates = {states}" for i in range(3)).replace("'", '"')
    assert "found 1030301 joint states" in refused(written(tmp_path, text))


def test_groups_of_more_than_three_are_refused_with_the_number(tmp_path: Path) -> None:
    """Derived properties that link more than three continuous ones are refused, however they chain."""
    flat = 'unit = "g"\nfamily = "uniform"\nlow = 0\nhigh = 1\n'
    text = "".join(f"[properties.{name}]\n{flat}" for name in "abcd")
    text += '[properties.s]\nunit = "g"\nformula = "a + b"\n[properties.t]\nunit = "g"\nformula = "c + d"\n'
    assert load_network(written(tmp_path, text)).derived
    message = refused(written(tmp_path, text + '[properties.u]\nunit = "g"\nformula = "s + c"\n'))
    assert "properties.u.formula: found a formula that links 4 continuous properties (a, b, c, d)" in message


def test_syntax_error_names_file_and_line(tmp_path: Path) -> None:
    """What is not TOML is refused with the line."""
    path = written(tmp_path, "[properties.a\nstates = 3")
    assert refused(path).startswith(f"{path}: found a TOML syntax error")
    assert "line 2" in refused(path)


def test_missing_file_lists_the_shipped_networks(tmp_path: Path) -> None:
    """A name or path that is not there says which networks ship."""
    message = refused(tmp_path / "nothing.toml")
    assert "found no such file" in message
    assert "'household', 'household-filled', 'pantry'" in message


@pytest.mark.parametrize("text", ["", "name = 'x'"])
def test_a_file_without_properties_is_refused(text: str, tmp_path: Path) -> None:
    """A network has at least one property."""
    assert "expected at least one table [properties.NAME]" in refused(written(tmp_path, text))


def test_another_format_is_refused(tmp_path: Path) -> None:
    """The format names its version; another one is not read."""
    path = tmp_path / "new.toml"
    path.write_text('format = "palpate-network/2"')
    assert refused(path) == f"{path}: format: found 'palpate-network/2'; expected 'palpate-network/1'"


def test_bytes_that_are_not_text_are_refused(tmp_path: Path) -> None:
    """A binary file is one clear error."""
    path = tmp_path / "image.toml"
    path.write_bytes(b"\xff\xfe\x00")
    assert "not UTF-8" in refused(path)


def test_files_that_extend_each_other_are_refused(tmp_path: Path) -> None:
    """A circle of `extends` has no end and is an error."""
    written(tmp_path, 'extends = "b.toml"', "a.toml")
    written(tmp_path, 'extends = "a.toml"', "b.toml")
    assert "extends: found a circle of files" in refused(tmp_path / "a.toml")


def test_an_error_names_the_file_that_the_value_is_from(tmp_path: Path) -> None:
    """In a variant, a fault of the file it extends is reported for that file, its own for itself."""
    base = written(tmp_path, BASE.replace("sd = 30", "sd = -30"), "base.toml")
    variant = written(tmp_path, 'extends = "base.toml"\n[actions.look]\ncost_s = 3')
    assert refused(variant).startswith(f"{base}: properties.volume.given.mug.sd")
    worse = written(tmp_path, 'extends = "base.toml"\n[properties.volume.given.mug]\nsd = -1')
    assert refused(worse).startswith(f"{worse}: properties.volume.given.mug.sd: found -1")


CSV = {
    "no header": ("", "line 1: found nothing"),
    "wrong states": ("t,mug,bix\nmug,1,0\nbox,0,1", "line 1: found mug, bix; expected each true state once: mug, box"),
    "no rows": ("t,mug,box", "column 1: found nothing; expected each outcome once"),
    "twice": ("t,mug,box\nmug,1,0\nmug,0,1", "column 1: found mug, mug"),
    "not a number": ("t,mug,box\nmug,1,x\nbox,0,1", "row 'mug', column 3: found 'x'; expected a number"),
    "short row": ("t,mug,box\nmug,1\nbox,0,1", "row 'mug', column 3: found nothing"),
    "long row": ("t,mug,box\nmug,1,0\nbox,0,1,0", "row 'box': found 4 cells; expected 3, as in line 1"),
    "sum": ("t,mug,box\nmug,1,0\nbox,0.5,1", "mug: found probabilities that sum to 1.5; expected a sum of 1"),
}


@pytest.mark.parametrize("case", CSV)
def test_bad_csv(case: str, tmp_path: Path) -> None:
    """A fault of a confusion matrix in CSV names the network file and the key, and the place in the CSV file."""
    text, part = CSV[case]
    (tmp_path / "look.csv").write_text(text)
    start, end = BASE.index("[actions.look.sensor.given]"), BASE.index("[actions.weigh]")
    network = written(tmp_path, BASE[:start] + 'csv = "look.csv"\n' + BASE[end:])
    message = refused(network)
    assert message.startswith(f"{network}: actions.look.sensor.csv: found a table that cannot be used: ")
    assert f"{tmp_path / 'look.csv'}: " in message
    assert part in message


def test_missing_csv(tmp_path: Path) -> None:
    """A CSV file that is not there is named, with the network file and the key that name it."""
    start, end = BASE.index("[actions.look.sensor.given]"), BASE.index("[actions.weigh]")
    network = written(tmp_path, BASE[:start] + 'csv = "gone.csv"\n' + BASE[end:])
    message = refused(network)
    assert message.startswith(f"{network}: actions.look.sensor.csv: ")
    assert f"{tmp_path / 'gone.csv'}: found no readable CSV file" in message
