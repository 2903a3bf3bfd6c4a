"""Reading a network from TOML.

The format, ``palpate-network/1``::

    format = "palpate-network/1"
    name = "kitchen"                    # optional: the name of the file
    description = "..."                 # optional, as `source`: here, of properties and of sensors
    extends = "household"               # optional: a shipped network, or a path from this file;
                                        # tables merge deeply, values here win, lists are replaced

    [properties.category]               # categorical: it has states
    states = ["mug", "box"]
    prior = [0.7, 0.3]                  # or {mug = 0.7, box = 0.3}; without it: uniform

    [properties.material]
    states = ["metal", "paper"]
    parents = ["category"]              # categorical ones; with several, `given` is nested in
    [properties.material.given]         # their order: given.mug.large = [...]
    mug = [1, 0]                        # sums to one; names left out of a table are 0
    box = {paper = 1}

    [properties.volume]                 # continuous: it has a family
    unit = "cm^3"
    family = "truncated-normal"
    low = 0                             # parameters here hold for all configurations
    parents = ["category"]
    [properties.volume.given]
    mug = {mean = 90, sd = 30}
    box = {mean = 20, sd = 10}

    [properties.density]
    unit = "kg/m^3"
    family = "lognormal"                # without parents the parameters stand here
    median = 900
    log_sd = 0.7

    [properties.mass]                   # derived: it has a formula over other properties, as
    unit = "g"                          # quantities: units convert by themselves
    formula = "density * volume"

    [actions.look]
    cost_s = 1
    sees_appearance = true              # simulated from what the object looks like
    [actions.look.sensor]
    property = "category"
    kind = "confusion"
    outcomes = ["mug", "box", "other"]  # without it: the states
    repeat_probability = 0.5            # share of looks that repeat one hidden label; default 0
    [actions.look.sensor.given]         # or: csv = "look.csv", rows outcomes, columns true states
    mug = [0.8, 0.1, 0.1]
    box = [0.1, 0.8, 0.1]

    [actions.weigh]
    cost_s = 15
    [actions.weigh.sensor]              # numbers in the property's unit
    property = "mass"
    kind = "normal"                     # or "student-t", with scale, relative_scale, dof
    sd = 6                              # and/or relative_sd, a fraction of the true value
    saturates_above = 5000              # and/or saturates_below
    offset_sd = 2                       # common to all readings of one object; default 0
    bias = 1.5                          # readings are so much too high on average; default 0

    [objects.tin_mug]                   # for simulation and scoring
    description = "..."
    looks_like = "other_object"         # optional: a trick
    [objects.tin_mug.truth]             # every property; derived ones may be left out
    category = {value = "mug", status = "measured", source = "seen"}   # measured, assumed, unknown
    material = "metal"                  # a value alone is assumed
    volume = 15
    density = 7900
    mass = {value = 118, status = "measured", source = "kitchen scale"}   # fits the formula to 5 %

    # How often what was seen, where numbers were estimated; checked, and not part of the model:
    # [properties.category]          counts = [7, 3]              objects of each state
    # [properties.material.counts]   mug = [7, 0]                 as `given`, with every state
    # [properties.volume.counts]     mug = 7                      objects
    # [actions.look.sensor.counts]   mug = [31, 4, 0]             as `given`: outcomes
    # [actions.weigh.sensor]         counts = {objects = 10, readings = 52}
    # [provenance]                   any keys                     what the numbers were made from

Families and their parameters: normal (mean, sd), truncated-normal (mean and sd before truncation,
low and/or high), lognormal (median, log_sd), gamma (shape, scale), uniform (low, high), student-t
(location, scale, dof).
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from palpate.errors import NetworkError, choices, near
from palpate.network.document import Layer, Section, merge, open_layer
from palpate.network.model import Network
from palpate.network.reading_actions import read_actions
from palpate.network.reading_objects import read_objects
from palpate.network.reading_properties import read_properties

__all__ = ["FORMAT", "load_network", "network_of", "read_document", "shipped_networks"]

FORMAT = "palpate-network/1"
KEYS = ("format", "name", "description", "source", "extends", "properties", "actions", "objects", "provenance")
SHIPPED = Path(__file__).parents[1] / "data"


def shipped_networks() -> tuple[str, ...]:
    """Names of the networks that come with the package.

    Examples
    --------
    >>> "household" in shipped_networks()
    True
    """
    return tuple(sorted(path.stem for path in SHIPPED.glob("*.toml")))


def load_network(name_or_path: str | Path) -> Network:
    """Read and validate a network.

    Parameters
    ----------
    name_or_path
        The name of a shipped network, or the path of a TOML file (format: see this module).

    Raises
    ------
    NetworkError
        If the file cannot be used; the message names the file, the key, what was found and what
        was expected.

    Examples
    --------
    >>> network = load_network("household")
    >>> list(network.properties)
    ['category', 'material', 'elasticity', 'density', 'volume', 'mass']
    """
    return network_of(read_document(name_or_path))


def read_document(name_or_path: str | Path) -> Section:
    """Read the tables of a network file over those of the files it extends; what is in them is not checked.

    Parameters
    ----------
    name_or_path
        As for `load_network`.

    Raises
    ------
    NetworkError
        If a file cannot be read, or is of another format.
    """
    return _read_layers(_find(name_or_path, Path()))


def network_of(document: Section) -> Network:
    """Make a network of the tables of its file.

    Raises
    ------
    NetworkError
        As `load_network`.
    """
    document.only(KEYS)
    for key in ("description", "source"):
        document.text(key, "")
    properties = read_properties(document)
    actions = read_actions(document, properties)
    objects = read_objects(document, properties)
    if "provenance" in document:
        document.section("provenance")
    name = document.text("name", Path(document.layers[-1].file).stem)
    return Network(name, properties, actions, objects, document.text("description", ""))


def _find(name_or_path: str | Path, folder: Path) -> Path:
    if str(name_or_path) in shipped_networks():
        return SHIPPED / f"{name_or_path}.toml"
    path = folder / Path(name_or_path).expanduser()
    if not path.is_file():
        hint = near(str(name_or_path), shipped_networks())
        problem = f"{path}: found no such file{hint}; give the path of a TOML file, or for a shipped network"
        raise NetworkError(f"{problem} {choices(shipped_networks())}")
    return path


def _read_layers(path: Path) -> Section:
    """The file over those it extends."""
    layers: list[Layer] = []
    tables: dict[str, object] = {}
    seen: list[Path] = []
    while path.resolve() not in seen:
        seen.append(path.resolve())
        layer = open_layer(path)
        _check_format(layer)
        _anchor_csv(layer, path.parent)
        layers.insert(0, layer)
        tables = merge(layer.tables, tables)
        if "extends" not in layer.tables:
            return Section(tables, layers)
        path = _find(Section(layer.tables, [layer]).text("extends"), path.parent)
    raise Section(tables, layers).error("found a circle of files that extend each other; expected an end", "extends")


def _check_format(layer: Layer) -> None:
    found = Section(layer.tables, [layer]).text("format")
    if found != FORMAT:
        raise Section(layer.tables, [layer]).error(f"found {found!r}; expected {FORMAT!r}", "format")


def _anchor_csv(layer: Layer, folder: Path) -> None:
    """Make the paths of CSV files, which start at the file that names them, independent of it."""
    actions = layer.tables.get("actions")
    for action in actions.values() if isinstance(actions, Mapping) else ():
        sensor = action.get("sensor") if isinstance(action, Mapping) else None
        if isinstance(sensor, dict) and isinstance(sensor.get("csv"), str):
            sensor["csv"] = str(folder / sensor["csv"])
