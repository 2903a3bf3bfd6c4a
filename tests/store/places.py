"""Where stores for tests are; those that need a service are skipped where the service is not told."""

import os
import uuid
from pathlib import Path
from urllib.request import Request, urlopen

import obstore
import pytest
from sqlalchemy import create_engine, make_url, text

from palpate.store.blobs import Blobs, FolderBlobs
from palpate.store.bucket import BucketBlobs
from palpate.store.database import connect


def own_database(place: str | None, process: str | None) -> str | None:
    """The address of the database that tests of this process may empty: of several each has its own."""
    if place is None or process is None:
        return place
    engine = create_engine(place, isolation_level="AUTOCOMMIT")
    with engine.connect() as connection:
        if connection.scalar(text("SELECT count(*) FROM pg_database WHERE datname = :name"), {"name": process}) == 0:
            connection.execute(text(f"CREATE DATABASE {process}"))
    engine.dispose()
    return make_url(place).set(database=process).render_as_string(hide_password=False)


POSTGRESQL = own_database(os.environ.get("PALPATE_TEST_POSTGRESQL"), os.environ.get("PYTEST_XDIST_WORKER"))
"""Address of a PostgreSQL database that the tests may empty."""
S3 = os.environ.get("PALPATE_TEST_S3")
"""Address of an S3-compatible store that lets everybody make buckets."""
KINDS = ["sqlite", "bucket", "s3", "postgresql"]


def check_services(kind: str) -> None:
    """Skip where a service is needed and not told."""
    if kind == "postgresql" and POSTGRESQL is None:
        pytest.skip("PALPATE_TEST_POSTGRESQL is not set")
    if kind == "s3" and S3 is None:
        pytest.skip("PALPATE_TEST_S3 is not set")


def blobs_of(kind: str, folder: Path, patch: pytest.MonkeyPatch) -> Blobs:
    """A new place for blobs: a bucket in a real store where one is told, else in memory; for other kinds a folder."""
    if S3 is not None and kind in ("s3", "postgresql"):
        return BucketBlobs(new_bucket(patch))
    # obstore's own store in memory stands for a bucket
    return BucketBlobs("memory:///") if kind == "bucket" else FolderBlobs(folder / "blobs")


def new_bucket(patch: pytest.MonkeyPatch) -> str:
    """Make a bucket, and set what the environment must tell of it."""
    assert S3 is not None
    for name, value in (
        ("AWS_ACCESS_KEY_ID", "tests"),
        ("AWS_SECRET_ACCESS_KEY", "tests"),
        ("AWS_REGION", "us-east-1"),
        ("AWS_ENDPOINT_URL", S3),
    ):
        patch.setenv(name, value)
    name = f"tests-{uuid.uuid4()}"
    with urlopen(Request(f"{S3}/{name}", method="PUT")):
        return f"s3://{name}/blobs"


def emptied() -> str:
    """The database for tests, without tables, whatever a test that failed has left in it."""
    assert POSTGRESQL is not None
    engine = connect(POSTGRESQL)
    with engine.begin() as connection:
        connection.exec_driver_sql("DROP SCHEMA public CASCADE")
        connection.exec_driver_sql("CREATE SCHEMA public")
    engine.dispose()
    return POSTGRESQL


def damage(blobs: Blobs, digest: str, data: bytes | None) -> None:
    """Write other bytes in place of a blob, or remove it, past all that guards it."""
    if isinstance(blobs, FolderBlobs):
        path = blobs.folder / digest[:2] / digest[2:]
        path.unlink() if data is None else path.write_bytes(data)
        return
    assert isinstance(blobs, BucketBlobs)
    key = f"{digest[:2]}/{digest[2:]}"
    obstore.delete(blobs._store, key) if data is None else obstore.put(blobs._store, key, data)
