"""`palpate network fit`: from files to a file, whole or not at all."""

from pathlib import Path
from typing import Any

import pytest

from palpate.network.reading import load_network, read_document
from palpate.store.opening import open_store
from tests.fitting.made_up import drawn, fill, network_of, workshop, write_csv
from tests.fitting.test_template import BLANK


@pytest.fixture
def lab(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder with a template, a store and tables of 40 objects."""
    network = network_of(tmp_path)
    specimens = drawn(network, 40, 1)
    write_csv(tmp_path, network, specimens)
    with open_store(tmp_path / "store.sqlite", durable=False) as store:
        fill(store, network, specimens)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PALPATE_STORE", "own.sqlite")
    return tmp_path


def files(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()}


def test_from_tables(run: Any, lab: Path) -> None:
    """Tables give a network that is valid; counts, scores and what was odd are told."""
    fitted = run("network", "fit", "--like", "workshop.toml", "--csv", "objects.csv", "--csv-readings", "readings.csv",
                 "-o", "own.toml", "--folds", "4")  # fmt: skip
    assert fitted.code == 0
    for part in (
        "40 objects from csv objects.csv, csv readings.csv",
        "density",
        "40, 80",
        "mean error",
        "own.toml: written",
    ):
        assert part in fitted.out
    assert run("network", "check", "own.toml").code == 0
    provenance = read_document("own.toml").section("provenance").tables
    assert "--csv objects.csv --csv-readings readings.csv" in str(provenance["command"])
    assert "date" not in provenance


def test_from_a_store(run: Any, lab: Path) -> None:
    """A store gives the same numbers as the tables, and the date of its last recording."""
    run("network", "fit", "--like", "workshop.toml", "--csv", "objects.csv", "--csv-readings", "readings.csv",
        "-o", "tables.toml", "--folds", 0)  # fmt: skip
    fitted = run("network", "fit", "--like", "workshop.toml", "--store", "store.sqlite", "-o", "own.toml", "--folds", 0)
    assert fitted.code == 0
    assert "log2 p" not in fitted.out
    # objects of a store are named with their dataset
    one, other = (Path(name).read_text().split("[provenance]")[0] for name in ("tables.toml", "own.toml"))
    assert one.replace('name = "tables"', 'name = "own"') == other.replace("made_up/", "")
    assert read_document("own.toml").section("provenance").tables["date"] == "2024-05-01"


def test_a_template_without_numbers(run: Any, lab: Path) -> None:
    """Structure alone is enough, as all numbers are in the data."""
    workshop(lab, BLANK)
    fitted = run("network", "fit", "--like", "workshop.toml", "--store", "store.sqlite", "-o", "own.toml", "--date",
                 "2026-01-31", "--folds", 3)  # fmt: skip
    assert fitted.code == 0
    assert "without parents" in fitted.out
    assert list(load_network("own.toml").actions) == ["look", "weigh", "scratch"]
    assert read_document("own.toml").section("provenance").tables["date"] == "2026-01-31"


def test_a_filter_is_in_the_command(run: Any, lab: Path) -> None:
    """Which readings were used is part of the provenance; with none of them, sensors stay as they are."""
    fitted = run("network", "fit", "--like", "workshop.toml", "--store", "store.sqlite", "-o", "own.toml",
                 "--since", "1999-01-01", "--until", "2000-01-01", "--keep", "kind", "--folds", 0)  # fmt: skip
    assert "look, weigh, scratch: as in the template: no data" in fitted.out
    command = read_document("own.toml").section("provenance").text("command")
    assert "--since 1999-01-01 --until 2000-01-01 --pseudo-count 0.2 --keep kind --output own.toml" in command


CSV = ("--csv", "objects.csv", "--csv-readings", "readings.csv")
REFUSED = {
    "nothing": ((), "there is no store at"),
    "both": (
        ("--store", "store.sqlite", *CSV),
        "--store: for a store alone, and --csv was found; expected one of them",
    ),
    "no store": (("--store", "nowhere.sqlite"), "there is no store at"),
    "no table": (("--csv", "nowhere.csv"), "nowhere.csv: found a file that cannot be read"),
    "gripper": ((*CSV, "--gripper", "soft"), "--gripper: for a store alone, and --csv was found"),
    "unknown": (("--store", "store.sqlite", "--gripper", "soft"), "--gripper: the store has no gripper 'soft'"),
    "readings": (("--store", "store.sqlite", "--csv-readings", "readings.csv"), "for tables alone, expected --csv"),
    "column": ((*CSV, "--column", "mass"), "--column: 'mass' was found, expected COLUMN=PROPERTY"),
    "since": (("--store", "store.sqlite", "--since", "soon"), "--since: 'soon' was found"),
    "date": ((*CSV, "--date", "soon"), "--date: 'soon' was found, expected a date such as 2024-05-01"),
    "count": ((*CSV, "--pseudo-count", "0"), "pseudo-count: found 0; expected a number above 0"),
    "keep": ((*CSV, "--keep", "wiegh"), "palpate: --keep: found 'wiegh' (did you mean 'weigh'?)"),
    "folds": ((*CSV, "--folds", "1"), "--folds: found 1, expected 2 at least, or 0 for no scores"),
    "empty": (("--csv", "empty.csv"), "found 0 objects, from which nothing of the network can be estimated"),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_is_wrong_is_refused(run: Any, lab: Path, case: str) -> None:
    """Bad options and files are one sentence and exit code 2, and no file is made or changed."""
    (lab / "empty.csv").write_text("object\n")
    options, message = REFUSED[case]
    before = files(lab)
    assert message in run("network", "fit", "--like", "workshop.toml", *options, "-o", "own.toml").refused
    assert files(lab) == before


def test_a_template_that_is_not_there_and_an_output_that_cannot_be(run: Any, lab: Path) -> None:
    """The template and the place of the output are checked first."""
    assert "did you mean 'household'?" in run("network", "fit", "--like", "houshold", *CSV, "-o", "own.toml").refused
    refused = run("network", "fit", "--like", "workshop.toml", *CSV, "-o", "nowhere/own.toml").refused
    assert "--output: the folder nowhere does not exist" in refused


def test_an_output_is_replaced_when_asked(run: Any, lab: Path) -> None:
    """A file that is there stays unless --force is given, and where a fit fails; it may be the template."""
    before = (lab / "workshop.toml").read_text()
    onto = ("network", "fit", "--like", "workshop.toml", "-o", "workshop.toml")
    refused = run(*onto, *CSV, "--folds", 0).refused
    assert "--output: workshop.toml exists already, expected the name of a new file, or --force" in refused
    assert run(*onto, "--csv", "no.csv", "--force").code == 2
    assert (lab / "workshop.toml").read_text() == before
    assert run(*onto, *CSV, "--folds", 0, "--force").code == 0
    assert "provenance" in (lab / "workshop.toml").read_text()


def test_objects_of_the_template_are_left_out(run: Any, lab: Path) -> None:
    """They are others than those that the network was fitted to, and it is told."""
    truth = "kind = 'bolt'\nmetal = 'brass'\ndensity = 8\nvolume = 2\nhardness = 1\n"
    (lab / "workshop.toml").write_text((lab / "workshop.toml").read_text() + f"\n[objects.lamp.truth]\n{truth}")
    assert list(load_network("workshop.toml").objects) == ["lamp"]
    fitted = run("network", "fit", "--like", "workshop.toml", *CSV, "-o", "own.toml", "--folds", 0)
    assert "the 1 known object of the template are others, and are left out" in " ".join(fitted.out.split())
    assert not load_network("own.toml").objects


def test_the_store_of_the_environment_is_taken(run: Any, lab: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without --store and --csv the store is the one that other commands take."""
    monkeypatch.setenv("PALPATE_STORE", "store.sqlite")
    fitted = run("network", "fit", "--like", "workshop.toml", "-o", "own.toml", "--folds", 0)
    assert fitted.code == 0
    place = f"sqlite:///{lab / 'store.sqlite'}"
    assert fitted.out.splitlines()[0] == f"data from {place}, as neither --store nor --csv was given"
    assert "--store" not in read_document("own.toml").section("provenance").text("command")


def test_a_password_stays_secret(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command in the file does not hold the password of a database."""
    from palpate.cli.fit_data import From
    from palpate.cli.fit_options import OfStore, Tables
    from palpate.cli.store_options import Place

    told = From(Place("postgresql+psycopg://ann:secret@host/lab"), OfStore(), Tables()).words
    assert told == ["--store", "postgresql+psycopg://ann:***@host/lab"]
