"""Programs that are killed while they put and import: what was acknowledged is there, and nothing is there in part."""

from pathlib import Path

import pytest

from palpate.cli import main
from palpate.store.archive import export_archive
from palpate.store.listing import list_recordings
from palpate.store.opening import open_store
from palpate.store.records import FileItem, Recording
from palpate.store.verifying import verify
from tests.killing import KILLS, kill_again_and_again, needs_sigkill
from tests.store.made_up import squeeze
from tests.store.places import S3, check_services, emptied, new_bucket

pytestmark = needs_sigkill

IMPORTS = """
import alembic.autogenerate, alembic.command, obstore.store, psycopg
from palpate.cli import main
from palpate.store.opening import open_store
from tests.store.test_killed import made
"""
PUT = """
with open_store(place, blobs) as store, open(acknowledged, "ab", buffering=0) as told:
    for number in range(1000 * attempt, 1000 * attempt + 1000):
        told.write(f"{number} {store.put(made(number)).digest}\\n".encode())
"""
IMPORT = """
main(["store", "import", archive, "--store", f"{folder}/{attempt}.sqlite"])
"""
RECORDINGS = 30


def made(number: int) -> Recording:
    """A recording with a file and a log of its own."""
    picture = FileItem("cam0", "image/png", b"picture %d" % number)
    return squeeze(number, files=(picture,), log=f"number {number}")


@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_a_kill_while_putting_loses_nothing(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Killed at any instant from opening to commit, all that was acknowledged is whole, and at most one more is."""
    check_services(kind)
    place = emptied() if kind == "postgresql" else str(tmp_path / "store.sqlite")
    blobs = new_bucket(monkeypatch) if kind == "postgresql" and S3 else str(tmp_path / "blobs")
    told = tmp_path / "acknowledged"
    arguments: dict[str, str | Path] = {"place": place, "blobs": blobs, "acknowledged": told}
    kill_again_and_again(IMPORTS, PUT, arguments, longest_s=0.2, progress=told)
    acknowledged = dict(line.split() for line in told.read_text().splitlines())
    assert acknowledged
    with open_store(place, blobs) as store:
        assert list(verify(store)) == []
        for number, digest in acknowledged.items():
            assert store.get(digest).digest == made(int(number)).digest
        # one may have been committed, and its program killed before it could say so
        assert len(acknowledged) <= count(place, blobs) <= len(acknowledged) + KILLS


@pytest.fixture
def archive(tmp_path: Path) -> Path:
    with open_store(tmp_path / "local.sqlite", durable=False) as local:
        local.put_many([made(number) for number in range(RECORDINGS)])
        export_archive(local, tmp_path / "archive")
    return tmp_path / "archive"


def test_a_kill_while_importing_leaves_whole_recordings(tmp_path: Path, archive: Path) -> None:
    """Killed at any instant, what is there of an import is whole, and to import again completes it."""
    folder = tmp_path / "stores"
    folder.mkdir()
    kill_again_and_again(IMPORTS, IMPORT, {"archive": archive, "folder": folder}, longest_s=0.6)
    wanted, counts = {made(number).digest for number in range(RECORDINGS)}, set[int]()
    for attempt in range(KILLS):
        place = folder / f"{attempt}.sqlite"
        with open_store(place) as store:
            assert list(verify(store)) == []
            counts.add(count(str(place), None))
        with pytest.raises(SystemExit) as ended:
            main(["store", "import", str(archive), "--store", str(place)])
        assert ended.value.code == 0
        with open_store(place) as store:
            assert {store.get(row.id).digest for row in list_recordings(store).rows} == wanted
            assert list(verify(store)) == []
    assert counts <= {0, RECORDINGS}, "an archive as small as this one is one transaction"


def count(place: str, blobs: str | None) -> int:
    with open_store(place, blobs) as store, store.engine.connect() as connection:
        return int(connection.exec_driver_sql("SELECT count(*) FROM recordings").scalar_one())
