"""The tables of a store.

A recording's ``document`` is what was hashed, and is what is read back; the columns beside it, and the rows of
``entries``, repeat parts of it for queries. Times are whole microseconds since 1970 (UTC), digests 32 bytes, JSON is
text.
"""

from __future__ import annotations

import sqlalchemy
from sqlalchemy import Column, ForeignKey, Index, MetaData, Table, UniqueConstraint, text

from palpate.store.cells import BigInteger, Boolean, Float, Integer, LargeBinary, String, Text

__all__ = [
    "audit",
    "descriptions",
    "devices",
    "entries",
    "episode_steps",
    "episodes",
    "files",
    "layouts",
    "metadata",
    "properties",
    "recordings",
    "senders",
    "series",
    "setup_devices",
    "setups",
    "thing_images",
    "thing_properties",
    "things",
    "tokens",
    "users",
]

# names of constraints, so that a migration can name what it drops
metadata = MetaData(
    naming_convention={
        "ix": "ix_%(column_0_N_label)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s_%(referred_table_name)s",
        "pk": "pk_%(table_name)s",
    }
)
# only a plain INTEGER is SQLite's own row number
Id = sqlalchemy.BigInteger().with_variant(sqlalchemy.Integer, "sqlite")
SEEN_BY = ("visibility", "embargoed_us", "owner", "uploaded_by")
"""Columns of which it depends who sees a recording."""


def _where(condition: str, *columns: str, name: str | None = None) -> Index:
    """An index over some of the rows only: each index that a row is not in is a page less to write."""
    return Index(name, *columns, sqlite_where=text(condition), postgresql_where=text(condition))


things = Table(
    "things",
    metadata,
    Column("id", Id, primary_key=True),
    Column("dataset", String, nullable=False),
    Column("name", String, nullable=False),
    Column("maker", String),
    Column("common_name", String),
    Column("attributes", Text, nullable=False),
    Column("aliases", Text, nullable=False),
    Column("merged_into", Id, ForeignKey("things.id"), index=True),
    UniqueConstraint("dataset", "name"),
)
thing_properties = Table(
    "thing_properties",
    metadata,
    Column("id", Id, primary_key=True),
    Column("thing_id", Id, ForeignKey("things.id"), nullable=False, index=True),
    Column("property", String, nullable=False),
    Column("source", String, nullable=False),
    Column("label", String),
    Column("document", Text, nullable=False),
    UniqueConstraint("thing_id", "property", "source"),
    _where("label IS NOT NULL", "property", "label", "thing_id"),
)
thing_images = Table(
    "thing_images",
    metadata,
    Column("thing_id", Id, ForeignKey("things.id"), primary_key=True),
    Column("name", String, primary_key=True),
    Column("media_type", String, nullable=False),
    Column("blob", LargeBinary(32), nullable=False),
)
properties = Table(
    "properties",
    metadata,
    Column("name", String, primary_key=True),
    Column("unit", String, nullable=False),
)
devices = Table(
    "devices",
    metadata,
    Column("id", Id, primary_key=True),
    Column("digest", LargeBinary(32), nullable=False, unique=True),
    Column("kind", String, nullable=False),
    Column("name", String, nullable=False, index=True),
    Column("maker", String),
    Column("calibrated_on", String),
    Column("document", Text, nullable=False),
)
setups = Table(
    "setups",
    metadata,
    Column("id", Id, primary_key=True),
    Column("digest", LargeBinary(32), nullable=False, unique=True),
    Column("gripper", String),
    Column("document", Text, nullable=False),
)
setup_devices = Table(
    "setup_devices",
    metadata,
    Column("setup_id", Id, ForeignKey("setups.id"), primary_key=True),
    Column("device_id", Id, ForeignKey("devices.id"), primary_key=True, index=True),
)
layouts = Table(
    "layouts",
    metadata,
    Column("id", Id, primary_key=True),
    Column("digest", LargeBinary(32), nullable=False, unique=True),
    Column("document", Text, nullable=False),
)
# what recordings say of their objects, each once
descriptions = Table(
    "descriptions",
    metadata,
    Column("id", Id, primary_key=True),
    Column("thing_id", Id, ForeignKey("things.id"), nullable=False),
    Column("digest", LargeBinary(32), nullable=False),
    Column("maker", String),
    Column("common_name", String),
    Column("aliases", Text, nullable=False),
    Column("words", Text, nullable=False),
    UniqueConstraint("thing_id", "digest"),
)
recordings = Table(
    "recordings",
    metadata,
    Column("id", Id, primary_key=True),
    Column("uuid", LargeBinary(16), nullable=False, unique=True),
    Column("digest", LargeBinary(32), nullable=False, unique=True),
    Column("recorded_us", BigInteger, nullable=False),
    Column("uploaded_us", BigInteger, nullable=False),
    Column("action", String, nullable=False),
    Column("thing_id", Id, ForeignKey("things.id"), nullable=False),
    Column("setup_id", Id, ForeignKey("setups.id"), nullable=False),
    Column("gripper", String),
    Column("owner", String),
    Column("visibility", String, nullable=False),
    Column("ground_truth", Boolean, nullable=False),
    Column("words", Text, nullable=False),
    Column("document", Text, nullable=False),
    Column("log", LargeBinary),
    Column("log_blob", LargeBinary(32)),
    Column("seal", LargeBinary(32)),
    Column("uploaded_by", String),
    Column("embargoed_us", BigInteger),
    # None where it says nothing of its object but dataset and name
    Column("description_id", Id, ForeignKey("descriptions.id")),
    Index(None, "recorded_us", "id"),
    # with all that says who sees a recording, so that those that somebody sees are counted without reading them
    Index("ix_recordings_of_thing", "thing_id", "recorded_us", "id", *SEEN_BY),
    Index("ix_recordings_of_setup", "setup_id", "recorded_us", "id", *SEEN_BY),
    # to go from one action to the next; did it begin with them, SQLite would read and sort all recordings of a common
    # one where a few of them are asked for
    Index("ix_recordings_of_action", "ground_truth", "action", *SEEN_BY),
    Index(None, "gripper", "recorded_us", "id"),
    _where("owner IS NOT NULL", "owner", "recorded_us", "id"),
    _where("description_id IS NOT NULL", "description_id", *SEEN_BY, name="ix_recordings_of_description"),
)
# beside the one that a recording names itself
senders = Table(
    "senders",
    metadata,
    Column("name", String, primary_key=True),
    Column("recording_id", Id, ForeignKey("recordings.id"), primary_key=True),
    Column("sent_us", BigInteger, nullable=False),
    sqlite_with_rowid=False,
)
series = Table(
    "series",
    metadata,
    Column("recording_id", Id, ForeignKey("recordings.id"), primary_key=True),
    Column("position", Integer, primary_key=True),
    Column("name", String, nullable=False),
    Column("layout_id", Id, ForeignKey("layouts.id"), nullable=False),
    Column("data", LargeBinary),
    Column("blob", LargeBinary(32)),
    sqlite_with_rowid=False,
)
files = Table(
    "files",
    metadata,
    Column("recording_id", Id, ForeignKey("recordings.id"), primary_key=True),
    Column("position", Integer, primary_key=True),
    Column("name", String, nullable=False),
    Column("media_type", String, nullable=False),
    Column("blob", LargeBinary(32), nullable=False),
)
entries = Table(
    "entries",
    metadata,
    Column("recording_id", Id, ForeignKey("recordings.id"), primary_key=True),
    Column("position", Integer, primary_key=True),
    Column("kind", String, nullable=False),
    Column("property", String),
    Column("value", Float),
    Column("sd", Float),
    Column("low", Float),
    Column("high", Float),
    Column("unit", String),
    Column("value_si", Float),
    Column("sd_si", Float),
    Column("label", String),
    Column("thing_id", Id, ForeignKey("things.id"), nullable=False),
    Column("setup_id", Id, ForeignKey("setups.id"), nullable=False),
    Column("gripper", String),
    Column("recorded_us", BigInteger, nullable=False),
    Index(None, "property", "recorded_us", "recording_id"),
    Index(None, "property", "gripper", "recorded_us", "recording_id"),
    _where("label IS NOT NULL", "property", "label", "recorded_us", "recording_id"),
    _where("value_si IS NOT NULL", "property", "thing_id", "setup_id", "value_si"),
    sqlite_with_rowid=False,
)
episodes = Table(
    "episodes",
    metadata,
    Column("id", Id, primary_key=True),
    Column("uuid", LargeBinary(16), nullable=False, unique=True),
    Column("digest", LargeBinary(32), nullable=False, unique=True),
    Column("started_us", BigInteger, nullable=False),
    Column("thing_id", Id, ForeignKey("things.id"), nullable=False),
    Column("owner", String),
    Column("visibility", String, nullable=False, server_default="private"),
    Column("actions", Integer, nullable=False, server_default="0"),
    Column("stop", Text),
    Column("document", Text, nullable=False),
    Column("uploaded_by", String),
    Column("embargoed_us", BigInteger),
    Index(None, "started_us", "id"),
    Index(None, "thing_id", "started_us", "id"),
)
episode_steps = Table(
    "episode_steps",
    metadata,
    Column("episode_id", Id, ForeignKey("episodes.id"), primary_key=True),
    Column("position", Integer, primary_key=True),
    Column("recording_id", Id, ForeignKey("recordings.id"), index=True),
    Column("document", Text, nullable=False),
)
audit = Table(
    "audit",
    metadata,
    Column("id", Id, primary_key=True),
    Column("at_us", BigInteger, nullable=False),
    Column("who", String),
    Column("what", String, nullable=False),
    Column("thing_id", Id, ForeignKey("things.id"), index=True),
    Column("detail", Text, nullable=False),
    Column("undone_us", BigInteger),
    Column("undone_by", String),
    Column("recording_id", Id, ForeignKey("recordings.id"), index=True),
    Column("episode_id", Id, ForeignKey("episodes.id"), index=True),
)
users = Table(
    "users",
    metadata,
    Column("id", Id, primary_key=True),
    Column("name", String, nullable=False, unique=True),
    Column("email", String),
    Column("password_hash", String),
    Column("role", String, nullable=False),
    Column("created_us", BigInteger, nullable=False),
    Column("oidc_issuer", String),
    Column("oidc_subject", String),
    Index(None, "oidc_issuer", "oidc_subject", unique=True),
)
tokens = Table(
    "tokens",
    metadata,
    Column("id", Id, primary_key=True),
    Column("user_id", Id, ForeignKey("users.id"), nullable=False, index=True),
    Column("digest", LargeBinary(32), nullable=False, unique=True),
    Column("role", String, nullable=False),
    Column("created_us", BigInteger, nullable=False),
    Column("expires_us", BigInteger),
    Column("revoked_us", BigInteger),
)
