"""CSV tables: what is read, and errors that name the line and the column."""

from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from palpate.errors import PalpateError
from palpate.fitting.csv_tables import Column, read_tables
from palpate.fitting.errors import FittingError
from palpate.network.model import Network
from palpate.network.reading import load_network
from palpate.outcomes import Above, Below, Label, Reading
from tests.fitting.made_up import drawn, network_of, write_csv

HEADER = "object,kind,metal,density [kg/m^3],volume\n"


@pytest.fixture
def network(tmp_path: Path) -> Network:
    return network_of(tmp_path)


def written(folder: Path, text: str, name: str = "objects.csv") -> Path:
    path = folder / name
    path.write_text(text, encoding="utf-8")
    return path


def test_what_is_written_is_read(network: Network, tmp_path: Path) -> None:
    """Objects and readings come back as they were, whatever the order of the lines."""
    specimens = drawn(network, 8, 1)
    objects, readings = write_csv(tmp_path, network, specimens)
    data = read_tables(network, objects, readings)
    assert list(data.specimens) == specimens
    header, *lines = objects.read_text().splitlines()
    objects.write_text("\n".join([header, *lines[::-1]]))
    assert read_tables(network, objects, readings).specimens == data.specimens
    assert [source.items for source in data.sources] == [8, 8 * 6]
    assert data.sources[0].name == "objects.csv"
    assert len(data.sources[0].sha256) == 64


def test_units_and_empty_cells(network: Network, tmp_path: Path) -> None:
    """A unit in the header converts, an empty cell is not known, what follows by a formula is."""
    text = HEADER + "a,bolt,,7800,2\nb,,steel,,\n"
    one, other = read_tables(network, written(tmp_path, text)).specimens
    assert one.truth == {"kind": "bolt", "density": pytest.approx(7.8), "volume": 2.0, "mass": pytest.approx(15.6)}
    assert other.truth == {"metal": "steel"}


def test_a_property_follows_from_a_derived_one(network: Network, tmp_path: Path) -> None:
    """Of mass and volume the density follows, and a notice says so; a mass that does not fit is told and kept."""
    text = "object,mass [kg],volume,density\na,0.0156,2,\nb,0.02,2,7.8\n"
    data = read_tables(network, written(tmp_path, text))
    assert data.specimens[0].truth["density"] == pytest.approx(7.8)
    assert data.specimens[1].truth["mass"] == pytest.approx(20.0)
    assert data.notices == (
        "density follows from mass = density * volume",
        "known mass differs from density * volume by more than 5%; both are kept",
    )


def test_outcomes_in_words(network: Network, tmp_path: Path) -> None:
    """Labels, numbers with and without a unit, bounds in words and signs, and failures are read."""
    objects = written(tmp_path, "object\na\n")
    lines = ["weigh,12", "weigh,0.012 kg", "weigh,> 30", "weigh,above 0.03 kg", "weigh,below 1", "weigh,<1"]
    lines += ["weigh,failed", "look,", "look,else", "weigh,99"]
    text = "object,action,outcome\n" + "".join(f"a,{line}\n" for line in lines)
    data = read_tables(network, objects, written(tmp_path, text, "readings.csv"))
    readings = data.specimens[0].readings
    assert readings["look"] == (Label("else"),)
    assert readings["weigh"] == (
        Reading(12.0),
        Reading(12.0),
        Above(30.0),
        Above(30.0),
        Below(1.0),
        Below(1.0),
        Above(35.0),
    )
    assert data.notices == (
        "action 'weigh': 99 g is beyond saturation and is read as above 35 g",
        "look: failed on a with: no reason was given; left out",
        "weigh: failed on a with: no reason was given; left out",
    )


def test_columns_may_be_told(network: Network, tmp_path: Path) -> None:
    """A column of another name, in another unit, or to be left out, is as it is told to be."""
    path = written(tmp_path, "\ufeffTitle,Weight (kg),price,mass\nx,0.5,3,\ny,0.25,4,\n")
    columns = {
        "Title": Column(None),
        "Weight (kg)": Column.parse("mass [kg]"),
        "price": Column(None),
        "mass": Column(None),
    }
    data = read_tables(network, path, columns=columns)
    assert [(one.name, one.truth) for one in data.specimens] == [
        ("line 000002", {"mass": 500.0}),
        ("line 000003", {"mass": 250.0}),
    ]


OBJECTS = {
    "state": (
        "a,bolt,steal,7800,2",
        "line 2, column 'metal': found the unknown state 'steal' of 'metal' (did you mean",
    ),
    "number": ("a,bolt,steel,7.8e,2", "line 2, column 'density [kg/m^3]': found '7.8e'; expected a number"),
    "comma": ('a,bolt,steel,"7,8",2', "found '7,8'; expected a number, with a point"),
    "nan": ("a,bolt,steel,nan,2", "column 'density [kg/m^3]': found nan; expected a finite number"),
    "inf": ("a,bolt,steel,7800,inf", "column 'volume': found inf; expected a finite number"),
    "below": ("a,bolt,steel,-7800,2", "found -7.8 g/cm^3; expected 'density' from 0 to inf g/cm^3"),
    "zero": ("a,bolt,steel,7800,0", "found 0 cm^3; expected 'volume' above 0 cm^3"),
    "twice": ("a,bolt,steel,7800,2\n\na,,,,", "line 4, column 'object': found 'a', as in line 2"),
    "nameless": (",bolt,steel,7800,2", "line 2, column 'object': found no name"),
    "short": ("a,bolt,steel,7800", "line 2: found 4 cells; expected 5, as in line 1"),
    "quote": ('a,"bolt', "line 2: found what is no CSV"),
}


@pytest.mark.parametrize("case", OBJECTS)
def test_wrong_objects_are_refused(network: Network, tmp_path: Path, case: str) -> None:
    """What is wrong in a line of objects is an error that names the line and the column."""
    line, message = OBJECTS[case]
    with pytest.raises(FittingError) as caught:
        read_tables(network, written(tmp_path, HEADER + line + "\n"))
    assert message in str(caught.value)
    assert "objects.csv: line" in str(caught.value)


HEADERS = {
    "unknown": (
        "object,metall",
        "column 'metall': found no property 'metall' (did you mean 'metal'?); choose from 'object', 'kind'",
    ),
    "dimension": ("object,mass [cm]", "column 'mass [cm]': unit 'cm' is length"),
    "unit": ("object,mass [blubs]", "column 'mass [blubs]': found an unknown unit 'blubs'"),
    "state": ("object,kind [g]", "found the unit 'g' of 'kind', which has states"),
    "again": ("object,mass [g],mass [kg]", "column 'mass [kg]': found a second column of 'mass'"),
    "same": ("object,mass,mass", "column 'mass': found a second column of this name"),
    "empty": ("object,,mass", "line 1, column 2: found no name"),
    "nothing": ("", "found an empty file"),
}


@pytest.mark.parametrize("case", HEADERS)
def test_wrong_headers_are_refused(network: Network, tmp_path: Path, case: str) -> None:
    """What is wrong in the names of columns is an error that names the column."""
    text, message = HEADERS[case]
    with pytest.raises(FittingError) as caught:
        read_tables(network, written(tmp_path, text + "\n"))
    assert message in str(caught.value)


READINGS = {
    "object": ("b,weigh,1", "line 2, column 'object': found 'b'; expected an object of"),
    "action": ("a,wiegh,1", "line 2, column 'action': found 'wiegh' (did you mean 'weigh'?)"),
    "label": ("a,look,bold", "line 2, column 'outcome': action 'look': unknown label 'bold' (did you mean 'bolt'?)"),
    "number": ("a,weigh,heavy", "column 'outcome': found 'heavy'; expected a number"),
    "bound": ("a,weigh,above", "column 'outcome': found 'above'; expected a number"),
    "unit": ("a,weigh,3 kPa", "column 'outcome': action 'weigh': unit 'kPa' is"),
    "odd unit": ("a,weigh,3 blubs", "unknown unit 'blubs'"),
    "nan": ("a,weigh,nan", "value nan was found, expected a finite number"),
}


@pytest.mark.parametrize("case", READINGS)
def test_wrong_readings_are_refused(network: Network, tmp_path: Path, case: str) -> None:
    """What is wrong in a line of readings is an error that names the line and the column."""
    line, message = READINGS[case]
    path = written(tmp_path, f"object,action,outcome\n{line}\n", "readings.csv")
    with pytest.raises(FittingError) as caught:
        read_tables(network, written(tmp_path, "object\na\n"), path)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("header", "message"),
    [
        ("object,action", "found no column 'outcome'; expected object, action, outcome"),
        ("object,action,outcome,unit", "column 'unit': found an unknown column"),
    ],
)
def test_wrong_headers_of_readings(network: Network, tmp_path: Path, header: str, message: str) -> None:
    """Readings have their three columns and no others."""
    path = written(tmp_path, f"{header}\n", "readings.csv")
    with pytest.raises(FittingError) as caught:
        read_tables(network, written(tmp_path, "object\na\n"), path)
    assert message in str(caught.value)


def test_files_that_cannot_be_read(network: Network, tmp_path: Path) -> None:
    """A file that is not there, or is no text, and a column that is told and is not there, are errors."""
    with pytest.raises(FittingError, match=r"nowhere\.csv: found a file that cannot be read"):
        read_tables(network, tmp_path / "nowhere.csv")
    (tmp_path / "bytes.csv").write_bytes(b"object\n\xff\n")
    with pytest.raises(FittingError, match="found bytes that are not UTF-8 at 7"):
        read_tables(network, tmp_path / "bytes.csv")
    with pytest.raises(FittingError, match=r"found no column 'prise' \(did you mean 'price'\?\); choose from"):
        read_tables(network, written(tmp_path, "object,price\n"), columns={"prise": Column(None)})


cells = st.sampled_from(
    ["", "a", "object", "metal", "mass [g]", "steel", "1", "-3", "nan", '"', "\n", "weigh", "> 3 g", "[", "é", "\0"]
)
texts = st.lists(st.lists(cells | st.text(max_size=4), max_size=4).map(",".join), max_size=4).map("\n".join)


@given(texts, texts)
def test_any_text_is_read_or_refused(tmp_path_factory: pytest.TempPathFactory, objects: str, readings: str) -> None:
    """Whatever is in the files, they are read, or there is one sentence of ours, and never another error."""
    folder = tmp_path_factory.mktemp("fuzz")
    first, second = folder / "a.csv", folder / "b.csv"
    first.write_bytes(objects.encode("utf-8", "surrogatepass"))
    second.write_bytes(readings.encode("utf-8", "surrogatepass"))
    network = load_network("household")
    # PalpateError alone may be raised
    with suppress(PalpateError):
        assert len(read_tables(network, first, second).sources) == 2
