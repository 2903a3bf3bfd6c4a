import json
import os
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import pytest

from palpate.cli import import_view
from palpate.store.archive import export_archive
from palpate.store.importing.items import Fate, Outcome
from palpate.store.importing.package import pack
from palpate.store.importing.report import Report
from palpate.store.opening import open_store
from tests.store.importing.bags.made import HEAD, ns, write_mcap
from tests.store.importing.bags.made import number as numbered
from tests.store.importing.test_uploads import labels, upload
from tests.store.made_up import squeeze


@pytest.fixture
def given(tmp_path: Path) -> Path:
    """A folder with an archive of three recordings, two upload dictionaries of which one is bad, and a note."""
    folder = tmp_path / "given"
    folder.mkdir()
    with open_store(tmp_path / "first.sqlite", durable=False) as store:
        store.put_many([squeeze(number) for number in range(3)])
        export_archive(store, folder / "archive")
    upload(folder, "mat-vision_0", labels("mat-vision", plastic=1.0), {})
    upload(folder, "mat-vision_1", labels("mat-vision", plastic=0.6), {})
    (folder / "notes.txt").write_text("hello")
    return folder


@pytest.fixture(autouse=True)
def place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("PALPATE_STORE", str(tmp_path / "store.sqlite"))
    monkeypatch.delenv("PALPATE_BLOBS", raising=False)
    return tmp_path / "store.sqlite"


def test_an_import_tells_what_became_of_everything(run: Any, given: Path) -> None:
    """Each refused and skipped file is told with the reason, then the counts; a refusal is exit code 1."""
    run("store", "object", "add", "our/mug")
    first, second = run("store", "import", given), run("store", "import", given)
    assert (first.code, first.err) == (1, "")
    refused, skipped, counts = first.out.splitlines()
    assert refused.startswith(f"refused: {given}/upload_dict")
    assert "sum to 0.6" in refused
    assert skipped == f"skipped: {given}/notes.txt: of no format that palpate knows"
    assert counts == "4 new, 0 there already, 1 refused, 1 skipped"
    assert second.out.splitlines()[-1] == "0 new, 4 there already, 1 refused, 1 skipped"
    assert run("store", "import", given / "archive").code == 0


def test_a_zip_file_is_imported_as_the_folder_that_it_is_of(run: Any, given: Path, tmp_path: Path) -> None:
    """What a server takes packed the command takes too; a zip file of which nothing came was meant all the same."""
    package = tmp_path / "session.zip"
    with package.open("xb") as opened:
        pack(squeeze(7), opened)
    run("store", "object", "add", "our/mug")
    done = run("store", "import", package)
    assert (done.code, done.out, done.err) == (0, "1 new, 0 there already, 0 refused, 0 skipped\n", "")
    shutil.make_archive(str(tmp_path / "given"), "zip", given)
    done = run("store", "import", tmp_path / "given.zip")
    *_, refused, skipped, counts = done.out.splitlines()
    assert refused.startswith(f"refused: {tmp_path}/given.zip/upload_dict")
    assert skipped == f"skipped: {tmp_path}/given.zip/notes.txt: of no format that palpate knows"
    assert (done.code, counts) == (1, "4 new, 0 there already, 1 refused, 1 skipped")
    with ZipFile(tmp_path / "notes.zip", "w") as made:
        made.writestr("notes.txt", "hello")
    done = run("store", "import", tmp_path / "notes.zip")
    assert (done.code, "nothing came of " in done.err) == (1, True)


def test_a_report_is_written(run: Any, given: Path, tmp_path: Path) -> None:
    """The report as JSON has the counts, and each file that was refused or skipped."""
    assert run("store", "import", given, "--report", tmp_path / "report.json").code == 1
    report = json.loads((tmp_path / "report.json").read_text())
    assert report["counts"] == {"new": 4, "known": 0, "mended": 0, "refused": 1, "skipped": 1}
    assert report["complete"]
    assert [Path(one["source"]).name for one in report["skipped"]] == ["notes.txt"]
    assert "sum to 0.6" in report["refused"][0]["reason"]


def test_decisions_are_printed_when_asked(run: Any, given: Path) -> None:
    """With --verbose each notice of each recording is told."""
    assert "the time is the one in the file's name" in run("store", "import", given, "-v").out
    assert "the time is" not in run("store", "import", given).out


def test_a_column_map_is_given(run: Any, tmp_path: Path, place: Path) -> None:
    """With --columns CSV files are imported; a map that is wrong is exit code 2 and no store."""
    (tmp_path / "a.csv").write_text("force\n1\n2\n")
    columns = tmp_path / "columns.toml"
    columns.write_text("action = 'squeezing'\n[channels.force]\n[object]\ndataset = 'a'\n")
    assert "found none of id, column and pattern" in run("store", "import", tmp_path, "--columns", columns).refused
    assert not place.exists()
    columns.write_text(columns.read_text() + "id = 'b'\n")
    done = run("store", "import", tmp_path / "a.csv", "--columns", columns)
    assert (done.code, done.out) == (0, "1 new, 0 there already, 0 refused, 0 skipped\n")


def test_the_example_is_shown(run: Any) -> None:
    """The example shows the object, its setup, five measurements and what was odd about them."""
    assert run("store", "import", "--example").out == "5 new, 0 there already, 0 refused, 0 skipped\n"
    shown = " ".join(run("store", "show").out.split())
    for text in (
        "5 recordings of 1 object",
        "011_banana",
        "robotiq_2f85",
        "mass 68.3 g",
        "the mean of elasticity is nan",
    ):
        assert text in shown
    assert "what was odd" in shown
    assert "holds grams and not a torque" in shown
    assert run("store", "import", "--example").out == "0 new, 5 there already, 0 refused, 0 skipped\n"


def test_what_cannot_begin_does_nothing(run: Any, given: Path, tmp_path: Path, place: Path) -> None:
    """A path that is not there, no path at all, or a report that cannot be written, is exit code 2 and no store."""
    assert "nowhere: no such file or folder" in run("store", "import", given, tmp_path / "nowhere").refused
    assert "nothing to import, expected files or folders" in run("store", "import").refused
    assert "there is no folder" in run("store", "import", given, "--report", tmp_path / "no" / "r.json").refused
    assert "is a folder" in run("store", "import", given, "--report", tmp_path).refused
    assert not place.exists()


@pytest.mark.parametrize("error", [KeyboardInterrupt, OSError(28, "No space left on device", "blobs")])
def test_a_broken_off_import_says_what_stays(
    run: Any, given: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, error: Any
) -> None:
    """Ctrl-C, or a full disk, ends with one sentence on what stays, and a report that says it is not all."""
    from palpate.store.importing import intake

    whole = intake.import_paths

    def broken(*arguments: Any, **more: Any) -> Iterator[Outcome]:
        outcomes = whole(*arguments, **more)
        yield next(outcomes)
        yield next(outcomes)
        raise error

    monkeypatch.setattr(intake, "import_paths", broken)
    ended = run("store", "import", given, "--report", tmp_path / "report.json")
    assert ended.code == (130 if error is KeyboardInterrupt else 2)
    assert "broken off after 1 new, 0 there already, 1 refused" in ended.err
    assert "the same command goes on from there" in ended.err
    assert json.loads((tmp_path / "report.json").read_text())["complete"] is False
    monkeypatch.undo()


def test_many_files_are_named_only_in_the_report() -> None:
    """Where hundreds are skipped, fifty are named and the others counted."""
    report = Report()
    for number in range(300):
        report.add(Outcome(f"{number}.txt", Fate.SKIPPED, "of no format"))
    lines = list(import_view.report_lines(report))
    assert len(lines) == 52
    assert lines[50] == "skipped: 250 more files, named in a file by --report FILE"
    assert len(report.plain()["skipped"]) == 300


@pytest.mark.parametrize("barren", ["notes.txt", "a.csv", "empty"])
def test_a_path_of_which_nothing_came_is_told(run: Any, given: Path, barren: str) -> None:
    """A file of no format, a table without a map and an empty folder are exit code 1 where they were named."""
    (given / "empty").mkdir()
    (given / "a.csv").write_text("force\n1\n2\n")
    run("store", "object", "add", "our/mug")
    done = run("store", "import", given / "archive", given / barren)
    assert (done.code, done.err) == (1, f"palpate: nothing came of {given / barren}, expected what can be imported\n")
    again = run("store", "import", given / "archive", given / barren, given / "empty", given / "notes.txt")
    assert again.code == 1
    assert f"nothing came of {given / barren} and {1 if barren != 'a.csv' else 2} more of the paths" in again.err


def test_what_is_skipped_in_a_folder_is_no_failure(run: Any, given: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Notes beside what can be imported are skipped, also where the folder is the one that one is in."""
    monkeypatch.chdir(given)
    next(given.glob("upload_dict*_1.json")).unlink()
    for folder in (".", given, f"../{given.name}"):
        done = run("store", "import", folder)
        assert "skipped: " in done.out
        assert (done.code, "nothing came" in done.err) == (0, False)


def test_a_picture_that_is_named_beside_its_file_is_used(run: Any, tmp_path: Path) -> None:
    """Where the shell names all files of a folder, a picture came with the recording that it belongs to."""
    (tmp_path / "eye.png").write_bytes(b"picture")
    file = upload(tmp_path, "cat-vision_0", labels("cat-vision", mug=1.0), {"eye": {"image": "eye.png"}})
    assert run("store", "import", file, tmp_path / "eye.png").code == 0


def test_an_archive_without_recordings_is_something(run: Any, tmp_path: Path) -> None:
    """One that holds an object alone gives it, and nothing is wrong."""
    run("store", "object", "add", "our/mug", "--store", tmp_path / "first.sqlite")
    assert run("store", "export", tmp_path / "objects", "--store", tmp_path / "first.sqlite").code == 0
    assert run("store", "import", tmp_path / "objects").code == 0
    assert "mug" in run("store", "objects").out


def test_names_of_files_cannot_command_a_terminal(run: Any, tmp_path: Path) -> None:
    """A name with a line break, an escape or bytes that are no text is one line of what can be printed."""
    (tmp_path / "given").mkdir()
    (tmp_path / "given" / os.fsdecode(b"a\n\x1b[2J\xff.txt")).write_text("")
    done = run("store", "import", tmp_path / "given")
    assert done.out.splitlines()[0] == f"skipped: {tmp_path}/given/a??[2J?.txt: of no format that palpate knows"
    assert done.code == 1


def test_a_bar_is_shown_in_a_terminal_only(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    """In a terminal the steps are counted and shown on standard error; elsewhere nothing is counted or shown."""
    with import_view.bar(lambda: pytest.fail("was counted")) as step:
        step()
    assert capsys.readouterr() == ("", "")
    monkeypatch.setenv("FORCE_COLOR", "1")
    with import_view.bar(lambda: 3) as step:
        step()
    printed = capsys.readouterr()
    assert printed.out == ""
    assert "Importing" in printed.err
    assert "1/3" in printed.err


@pytest.mark.parametrize("form", ["parquet", "hugging-face", "lerobot"])
def test_an_export_for_others_is_known_as_such(run: Any, tmp_path: Path, place: Path, form: str) -> None:
    """It is said once what it is and what to import in its place; the tables in it are known too."""
    with open_store(place) as store:
        store.put(squeeze(1, visibility="public", owner="x", licence="MIT"))
    exported = tmp_path / "exported"
    assert run("store", "export", exported, "--format", form).code == 0
    told = "is an export for others, which does not hold all that recordings are: import an archive"
    for path in (exported, next(exported.rglob("data/**/*.parquet"))):
        done = run("store", "import", path)
        first, counts = done.out.splitlines()
        assert first.startswith(f"skipped: {path}: {told}")
        assert counts == "0 new, 0 there already, 0 refused, 1 skipped"
        assert done.code == 1


def test_a_cut_bag_is_told_once(run: Any, tmp_path: Path) -> None:
    """The name of a single file stands once before what is odd about it, or wrong with it."""
    whole = write_mcap(tmp_path / "whole.mcap", [("/n", ns(i), numbered(i)) for i in range(200)], chunk_size=400)
    bytes_of = whole.read_bytes()
    topics = tmp_path / "topics.toml"
    topics.write_text(HEAD + '[topics."/n".series.s]\nx = {field = "data"}\n')
    for size in (300, len(bytes_of) // 2):
        (tmp_path / "cut.mcap").write_bytes(bytes_of[:size])
        lines = run("store", "import", tmp_path / "cut.mcap", "--topics", topics, "-v").out.splitlines()
        (line,) = [line for line in lines if "ends" in line]
        assert line.count("cut.mcap") == 1
