import os
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from palpate.errors import PalpateError
from palpate.store.checks import check
from palpate.store.entries import FailedEntry, Value
from palpate.store.errors import StoreError
from palpate.store.importing.columns import ColumnMap
from palpate.store.importing.formats import all_formats
from palpate.store.importing.intake import import_paths
from palpate.store.importing.items import Fate
from palpate.store.importing.reading_columns import read_columns
from palpate.store.importing.squeezes import read_squeeze
from palpate.store.records import Device, Recording
from palpate.store.store import Store
from palpate.store.verifying import verify

FULL = """
action = "squeezing"
owner = "our lab"

[time]
column = "t"
unit = "ms"

[channels.position]
column = "pos"
quantity = "length"
unit = "mm"

[channels.force]
unit = "N"

[results.elasticity]
column = "E"
unit = "kPa"
sd = 10

[object]
dataset = "sponges"
pattern = '(?P<id>[a-z]+)_'

[recorded]
pattern = '_(?P<time>[0-9]{8}T[0-9]{4})'
format = "%Y%m%dT%H%M"
zone = "Europe/Prague"

[setup.gripper]
name = "claw"
"""
BARE = """
action = "squeezing"
rate_hz = 100

[channels.force]
unit = "N"

[object]
dataset = "sponges"
id = "soft"
"""
ROWS = "t,pos,force,E\n0,60,0.5,12\n10,59.5,1.5,12\n20,59,2.5,12\n"


def column_map(folder: Path, text: str) -> ColumnMap:
    path = folder / "columns.toml"
    path.write_text(text, encoding="utf-8")
    return read_columns(path)


def squeezed(folder: Path, rows: str | bytes, columns: str = BARE, name: str = "soft_20240501T1430.csv") -> Recording:
    file = folder / name
    file.write_bytes(rows.encode() if isinstance(rows, str) else rows)
    return read_squeeze(file, column_map(folder, columns))


def test_a_squeeze_is_read(tmp_path: Path) -> None:
    """Samples, time stamps, result, object, devices and time are where the map says."""
    found = squeezed(tmp_path, ROWS, FULL)
    assert (found.action, found.owner, found.thing.dataset, found.thing.id) == (
        "squeezing",
        "our lab",
        "sponges",
        "soft",
    )
    assert found.setup.devices == (Device("gripper", "claw"),)
    # two hours ahead of UTC in summer
    assert found.recorded_at.astimezone(UTC) == datetime(2024, 5, 1, 12, 30, tzinfo=UTC)
    position, force = found.series[0].channels
    assert (found.series[0].name, position.name, position.quantity, position.unit) == (
        "claw",
        "position",
        "length",
        "mm",
    )
    assert position.values.tolist() == [60.0, 59.5, 59.0]
    assert (force.quantity, force.time_s is not None and force.time_s.tolist()) == ("force", [0.0, 0.01, 0.02])
    assert found.entries == (Value("elasticity", 12.0, 10.0, "kPa"),)
    assert found.notices == ()


def test_what_is_not_stated_is_noticed(tmp_path: Path) -> None:
    """The file's own time, missing samples and columns that nobody named are notices."""
    (tmp_path / "a.csv").write_text("force,x,y\n1,1,1\n,1,1\nnan,1,1\n")
    os.utime(tmp_path / "a.csv", ns=(0, 1_600_000_000_123_456_789))
    found = read_squeeze(tmp_path / "a.csv", column_map(tmp_path, BARE))
    assert found.recorded_at == datetime.fromtimestamp(1_600_000_000, UTC).replace(microsecond=123456)
    assert found.series[0].channels[0].rate_hz == 100.0
    assert np.isnan(found.series[0].channels[0].values).tolist() == [False, True, True]
    assert found.notices == (
        "force: 2 of 3 samples are missing",
        "the time is that of the last change of the file, as nothing else tells it",
        "the column map does not name 'x', 'y': they are left out",
    )
    found = squeezed(tmp_path, "force,x\n1,1\n", "keep_file = true\n" + BARE.replace("rate_hz = 100", ""))
    assert [item.name for item in found.files] == ["soft_20240501T1430.csv"]
    assert found.notices[0].startswith("neither time stamps nor a rate")
    assert found.notices[-1].endswith("they are in the file that is kept")


def test_other_ways_to_write_it(tmp_path: Path) -> None:
    """Another delimiter, decimal commas, quotes, an encoding, and lines before the names."""
    form = "\n[csv]\ndelimiter = ';'\ndecimal = ','\nquote = \"'\"\nencoding = 'latin-1'\nlines_before = 2\n"
    rows = "made by\nProgramm für Kräfte\n'force'; 'größe'\n1,5;'a;b'\n-2,25e1;x\n\n"
    found = squeezed(tmp_path, rows.encode("latin-1"), BARE + form)
    assert found.series[0].channels[0].values.tolist() == [1.5, -22.5]
    assert "'größe'" in found.notices[-1]
    marked = squeezed(tmp_path, b"\xef\xbb\xbfforce\n1\n")
    assert marked.series[0].channels[0].values.tolist() == [1.0]


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ("t,pos,force,E\n0,60,0.5,12\n10,wide,1.5,12\n", "line 3, column 'pos': found 'wide', expected a number"),
        ('t,pos,force,E\n0,60,"0,5",12\n', "line 2, column 'force': found '0,5', expected a number"),
        ("t,pos,force,E\n0,1_000,0.5,12\n", "line 2, column 'pos': found '1_000'"),
        ("t,pos,force,E\n,60,0.5,12\n", "line 2, column 't': found '', expected a time stamp"),
        ("t,pos,force,E\ninf,60,0.5,12\n", "line 2, column 't': found 'inf', expected a time stamp"),
        (
            "t,pos,force,E\n0,60,0.5,12\n20,60,0.5,12\n20,60,0.5,12\n10,60,0.5,12\n",
            "line 5, column 't': found '10', expected a time stamp that is not before '20' in line 4",
        ),
        ("t,pos,force,E\n0,60,0.5,12\n1,60,0.5,13\n", "line 3, column 'E': found '13', expected '12' as in"),
        ("t,pos,force,E\n0,60,0.5,soft\n", "line 2, column 'E': found 'soft', expected a number"),
        ("t,pos,force,E\n0,60,0.5\n", "line 2: 3 cells, expected 4 as in the names"),
        ("t,Pos,force,E\n0,60,0.5,1\n", "no column 'pos' (did you mean 'Pos'?); choose from 't', 'Pos', 'force', 'E'"),
        ("t,pos,force,E,t\n0,60,0.5,1,1\n", "two columns 't'"),
        ("t,pos,force,E\n", "has no samples"),
        ("", "has no samples"),
        ('t,pos,force,E\n0,60,"0.5,12\n', "line 2: cannot be read"),
        ("t,pos,force,E\n0,60,0.5,inf\n", "value: found inf"),
        (b"t,pos,force,E\n0,60,\xff,12\n", "is no text in utf-8"),
    ],
)
def test_an_error_names_line_and_column(tmp_path: Path, rows: str | bytes, message: str) -> None:
    """Whatever is wrong with a cell, the error says where it is and what would be right."""
    with pytest.raises(StoreError) as error:
        squeezed(tmp_path, rows, FULL)
    assert message in str(error.value)


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("SOFT_20240501T1430.csv", "the name does not fit the pattern"),
        ("soft_20241301T1430.csv", "found '20241301T1430' in the name, expected a time %Y%m%dT%H%M"),
    ],
)
def test_a_name_that_does_not_tell_is_refused(tmp_path: Path, name: str, message: str) -> None:
    """A file whose name has no object or no time in it, where it should, is refused."""
    with pytest.raises(StoreError, match=message):
        squeezed(tmp_path, ROWS, FULL, name)


def test_object_and_time_from_columns(tmp_path: Path) -> None:
    """One object and the first time of a file; two objects in one file are refused."""
    columns = BARE.replace('id = "soft"', 'column = "what"') + '\n[recorded]\ncolumn = "when"\n'
    found = squeezed(tmp_path, "force,what,when\n1,soft,2024-05-01T10:00:00\n2,,2024-05-01T10:00:01\n", columns)
    assert (found.thing.id, found.recorded_at) == ("soft", datetime(2024, 5, 1, 10, tzinfo=UTC))
    assert found.notices == ("the time states no time zone: UTC is assumed",)
    unix = columns + 'format = "unix"\n'
    found = squeezed(tmp_path, "force,what,when\n1,soft,1.5\n2,,2\n3,,\n", unix)
    assert (found.recorded_at, found.notices) == (datetime(1970, 1, 1, 0, 0, 1, 500_000, tzinfo=UTC), ())
    with pytest.raises(StoreError, match="line 3, column 'what': found 'hard', expected 'soft' as in"):
        squeezed(tmp_path, "force,what,when\n1,soft,5e8\n2,hard,2\n", unix)
    with pytest.raises(StoreError, match="column 'what' is empty"):
        squeezed(tmp_path, "force,what,when\n1,,5e8\n", unix)
    for wrong in ("soon", "nan", "1e300", ""):
        with pytest.raises(StoreError, match=f"column 'when': found '{wrong}', expected seconds since 1970"):
            squeezed(tmp_path, f"force,what,when\n1,soft,{wrong}\n", unix)


def test_no_result_is_a_failed_one(tmp_path: Path) -> None:
    """A column of results without a number is a failed measurement, with a notice; its SD may be a column too."""
    columns = FULL.replace("sd = 10", 'sd_column = "SD"')
    assert squeezed(tmp_path, "t,pos,force,E,SD\n0,1,1,12,2\n", columns).entries == (
        Value("elasticity", 12.0, 2.0, "kPa"),
    )
    for cell in ("", "nan"):
        found = squeezed(tmp_path, f"t,pos,force,E,SD\n0,1,1,{cell},2\n", columns)
        assert found.entries == (FailedEntry("no number in column 'E'", "elasticity"),)
        assert "a failed measurement" in found.notices[0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (('action = "squeezing"', ""), "found no 'action'; expected what the robot did"),
        (("rate_hz = 100", "rate = 100"), "rate: found the unknown key 'rate' (did you mean 'rate_hz'?)"),
        (("rate_hz = 100", "rate_hz = -1"), "rate_hz: found -1; expected a number above 0"),
        (("rate_hz = 100", "rate_hz = 100\ntime = {column = 't', unit = 's'}"), "time stamps as well as a rate"),
        (("rate_hz = 100", "time = {column = 't', unit = 'g'}"), "unit 'g' is mass"),
        (("rate_hz = 100", "visibility = 'all'"), "visibility: found 'all'"),
        (("[channels.force]", "[chanels.force]"), "chanels: found the unknown key 'chanels'"),
        (('unit = "N"', 'unit = "Nn"'), "unknown unit 'Nn'"),
        (('unit = "N"', 'unit = "g"'), "channels.force.unit: unit 'g' is mass"),
        (('id = "soft"', ""), "object: found none of id, column and pattern; expected one of them"),
        (('id = "soft"', "id = 'a'\ncolumn = 'b'"), "found id and column; expected one of"),
        (('id = "soft"', "pattern = '('"), "object.pattern: found no regular expression"),
        (('id = "soft"', "pattern = '[[]x'"), "object.pattern: found '[[]x'; expected a group (?P<id>...) in it"),
        (('id = "soft"', "pattern = '.*'"), "expected a group (?P<id>...) in it"),
        (('id = "soft"', "id = ''"), "object.id: is empty"),
        (('dataset = "sponges"', ""), "object: found no 'dataset'"),
        (("[object]", "[recorded]\n[object]"), "recorded: found neither column nor pattern"),
        (('action = "squeezing"', 'action = "squeezing"\nseries = ""'), "series: is empty, expected a name"),
        (("[object]", "[recorded]\ncolumn = 'a'\nzone = 'Prag'\n[object]"), "expected a time zone such as"),
        (("[object]", "[csv]\ndelimiter = ';;'\n[object]"), "csv.delimiter: found ';;'; expected one character"),
        (("[object]", "[csv]\ndecimal = ','\n[object]"), "found ',' for two things"),
        (("[object]", "[csv]\nencoding = 'klingon'\n[object]"), "csv.encoding: found 'klingon'"),
        (("[object]", "[setup.claw]\nname = 'x'\n[object]"), "setup: 'claw' is no device"),
        (("[object]", "[results.E]\nsd = 0\n[object]"), "results.E.sd: found 0"),
        (("[object]", "["), "TOML syntax error"),
    ],
)
def test_a_bad_map_is_an_error_with_file_and_key(tmp_path: Path, change: tuple[str, str], message: str) -> None:
    """A map that no recording can come of is refused before anything is read."""
    with pytest.raises(StoreError) as error:
        column_map(tmp_path, BARE.replace(*change))
    assert str(error.value).startswith(str(tmp_path / "columns.toml"))
    assert message in str(error.value)


def test_a_map_that_is_not_there(tmp_path: Path) -> None:
    """A file that cannot be read is named."""
    with pytest.raises(StoreError, match=r"no\.toml: found a file that cannot be read"):
        read_columns(tmp_path / "no.toml")


def test_files_without_a_map_are_skipped(local: Store, tmp_path: Path) -> None:
    """Without a column map a CSV is skipped with what is needed; with one it is imported, once."""
    folder = tmp_path / "given"
    folder.mkdir()
    (folder / "soft_20240501T1430.csv").write_text(ROWS)
    (folder / "soft_20240501T1431.CSV").write_text(ROWS)
    (skipped, *_) = import_paths(local, [folder], all_formats())
    assert (skipped.fate, "--columns" in str(skipped.reason)) == (Fate.SKIPPED, True)
    formats = all_formats(column_map(tmp_path, FULL))
    fates = [[one.fate for one in import_paths(local, [folder], formats)] for _ in "ab"]
    assert fates == [[Fate.NEW] * 2, [Fate.KNOWN] * 2]


cells = st.sampled_from(["1", "2.5", "-3e4", "", "nan", "inf", "x", "1,5", '"', "\0", "é", "1_0", "\uff12", "1e999"])
lines = st.lists(st.lists(cells, max_size=5).map(",".join), max_size=5).map("\n".join)


@given(
    st.sampled_from([FULL, BARE]), st.sampled_from(["t,pos,force,E\n", "force\n", ""]), lines | st.binary(max_size=30)
)
@settings(max_examples=200)
def test_any_csv_is_refused_or_kept(columns: str, names: str, rest: str | bytes) -> None:
    """Whatever is in a file, it is one sentence or a recording that a store keeps."""
    with TemporaryDirectory() as name, suppress(PalpateError):
        content = names.encode() + (rest.encode() if isinstance(rest, str) else rest)
        check(squeezed(Path(name), content, columns))


tables = st.recursive(
    st.text(max_size=4) | st.integers() | st.booleans() | st.sampled_from(["t", "force", "E", "unix", "s", "g", "("]),
    lambda inner: (
        st.lists(inner, max_size=2)
        | st.dictionaries(st.sampled_from(["column", "unit", "id", "pattern", "name", "x"]), inner, max_size=3)
    ),
    max_leaves=5,
)


@given(
    st.sampled_from(["action", "time", "channels", "results", "object", "recorded", "setup", "csv", "owner"]), tables
)
@settings(max_examples=100)
def test_any_map_is_refused_or_reads(key: str, value: object) -> None:
    """Whatever stands in a map, it is one sentence or a map that files are read or refused by."""
    import tomllib
    from unittest import mock

    changed = {**tomllib.loads(FULL), key: value}
    with TemporaryDirectory() as name, mock.patch("tomllib.loads", return_value=changed), suppress(PalpateError):
        check(squeezed(Path(name), ROWS, FULL))


def test_a_folder_of_good_and_bad_leaves_a_store_that_verifies(local: Store, tmp_path: Path) -> None:
    """Bad files are refused by line, and the good ones are all there."""
    folder = tmp_path / "given"
    folder.mkdir()
    for number in range(30):
        bad = "x" if number % 3 == 0 else "1"
        (folder / f"{number:02d}.csv").write_text(f"force\n{number}\n{bad}\n")
    told = list(import_paths(local, [folder], all_formats(column_map(tmp_path, BARE))))
    assert [one.fate for one in told].count(Fate.REFUSED) == 10
    assert {one.reason for one in told if one.fate is Fate.REFUSED} == {
        "line 3, column 'force': found 'x', expected a number"
    }
    assert list(verify(local)) == []
