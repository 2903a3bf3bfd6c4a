"""The first tables."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

__all__ = ["downgrade", "upgrade"]

revision = "0001"
down_revision = None


def upgrade() -> None:
    """Make the tables."""
    op.create_table(
        "devices",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("maker", sa.String(), nullable=True),
        sa.Column("calibrated_on", sa.String(), nullable=True),
        sa.Column("document", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_devices")),
        sa.UniqueConstraint("digest", name=op.f("uq_devices_digest")),
    )
    op.create_index(op.f("ix_devices_name"), "devices", ["name"], unique=False)
    op.create_table(
        "layouts",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_layouts")),
        sa.UniqueConstraint("digest", name=op.f("uq_layouts_digest")),
    )
    op.create_table(
        "properties",
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("unit", sa.String(), nullable=False),
        sa.PrimaryKeyConstraint("name", name=op.f("pk_properties")),
    )
    op.create_table(
        "setups",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("gripper", sa.String(), nullable=True),
        sa.Column("document", sa.Text(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_setups")),
        sa.UniqueConstraint("digest", name=op.f("uq_setups_digest")),
    )
    op.create_table(
        "things",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("dataset", sa.String(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("maker", sa.String(), nullable=True),
        sa.Column("common_name", sa.String(), nullable=True),
        sa.Column("attributes", sa.Text(), nullable=False),
        sa.Column("aliases", sa.Text(), nullable=False),
        sa.Column("merged_into", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=True),
        sa.ForeignKeyConstraint(["merged_into"], ["things.id"], name=op.f("fk_things_merged_into_things")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_things")),
        sa.UniqueConstraint("dataset", "name", name=op.f("uq_things_dataset_name")),
    )
    op.create_index(op.f("ix_things_merged_into"), "things", ["merged_into"], unique=False)
    op.create_table(
        "users",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("email", sa.String(), nullable=True),
        sa.Column("password_hash", sa.String(), nullable=True),
        sa.Column("role", sa.String(), nullable=False),
        sa.Column("created_us", sa.BigInteger(), nullable=False),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_users")),
        sa.UniqueConstraint("name", name=op.f("uq_users_name")),
    )
    op.create_table(
        "audit",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("at_us", sa.BigInteger(), nullable=False),
        sa.Column("who", sa.String(), nullable=True),
        sa.Column("what", sa.String(), nullable=False),
        sa.Column("thing_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=True),
        sa.Column("detail", sa.Text(), nullable=False),
        sa.Column("undone_us", sa.BigInteger(), nullable=True),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_audit_thing_id_things")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_audit")),
    )
    op.create_index(op.f("ix_audit_thing_id"), "audit", ["thing_id"], unique=False)
    op.create_table(
        "episodes",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("uuid", sa.LargeBinary(length=16), nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("started_us", sa.BigInteger(), nullable=False),
        sa.Column("thing_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_episodes_thing_id_things")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_episodes")),
        sa.UniqueConstraint("digest", name=op.f("uq_episodes_digest")),
        sa.UniqueConstraint("uuid", name=op.f("uq_episodes_uuid")),
    )
    op.create_index(op.f("ix_episodes_started_us"), "episodes", ["started_us"], unique=False)
    op.create_index(op.f("ix_episodes_thing_id"), "episodes", ["thing_id"], unique=False)
    op.create_table(
        "recordings",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("uuid", sa.LargeBinary(length=16), nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("recorded_us", sa.BigInteger(), nullable=False),
        sa.Column("uploaded_us", sa.BigInteger(), nullable=False),
        sa.Column("action", sa.String(), nullable=False),
        sa.Column("thing_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("setup_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("gripper", sa.String(), nullable=True),
        sa.Column("owner", sa.String(), nullable=True),
        sa.Column("visibility", sa.String(), nullable=False),
        sa.Column("ground_truth", sa.Boolean(), nullable=False),
        sa.Column("words", sa.Text(), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.Column("log", sa.LargeBinary(), nullable=True),
        sa.Column("log_blob", sa.LargeBinary(length=32), nullable=True),
        sa.ForeignKeyConstraint(["setup_id"], ["setups.id"], name=op.f("fk_recordings_setup_id_setups")),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_recordings_thing_id_things")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_recordings")),
        sa.UniqueConstraint("digest", name=op.f("uq_recordings_digest")),
        sa.UniqueConstraint("uuid", name=op.f("uq_recordings_uuid")),
    )
    op.create_index(
        op.f("ix_recordings_gripper_recordings_recorded_us_recordings_id"),
        "recordings",
        ["gripper", "recorded_us", "id"],
        unique=False,
    )
    op.create_index(
        op.f("ix_recordings_owner_recordings_recorded_us_recordings_id"),
        "recordings",
        ["owner", "recorded_us", "id"],
        unique=False,
        sqlite_where=sa.text("owner IS NOT NULL"),
        postgresql_where=sa.text("owner IS NOT NULL"),
    )
    op.create_index(op.f("ix_recordings_recorded_us_recordings_id"), "recordings", ["recorded_us", "id"], unique=False)
    op.create_index(
        op.f("ix_recordings_setup_id_recordings_recorded_us_recordings_id"),
        "recordings",
        ["setup_id", "recorded_us", "id"],
        unique=False,
    )
    op.create_index(
        op.f("ix_recordings_thing_id_recordings_recorded_us_recordings_id"),
        "recordings",
        ["thing_id", "recorded_us", "id"],
        unique=False,
    )
    op.create_table(
        "setup_devices",
        sa.Column("setup_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("device_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.ForeignKeyConstraint(["device_id"], ["devices.id"], name=op.f("fk_setup_devices_device_id_devices")),
        sa.ForeignKeyConstraint(["setup_id"], ["setups.id"], name=op.f("fk_setup_devices_setup_id_setups")),
        sa.PrimaryKeyConstraint("setup_id", "device_id", name=op.f("pk_setup_devices")),
    )
    op.create_index(op.f("ix_setup_devices_device_id"), "setup_devices", ["device_id"], unique=False)
    op.create_table(
        "thing_images",
        sa.Column("thing_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("media_type", sa.String(), nullable=False),
        sa.Column("blob", sa.LargeBinary(length=32), nullable=False),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_thing_images_thing_id_things")),
        sa.PrimaryKeyConstraint("thing_id", "name", name=op.f("pk_thing_images")),
    )
    op.create_table(
        "thing_properties",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("thing_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("property", sa.String(), nullable=False),
        sa.Column("document", sa.Text(), nullable=False),
        sa.Column("source", sa.Text(), nullable=True),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_thing_properties_thing_id_things")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_thing_properties")),
    )
    op.create_index(op.f("ix_thing_properties_thing_id"), "thing_properties", ["thing_id"], unique=False)
    op.create_table(
        "tokens",
        sa.Column("id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("user_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("digest", sa.LargeBinary(length=32), nullable=False),
        sa.Column("role", sa.String(), nullable=False),
        sa.Column("created_us", sa.BigInteger(), nullable=False),
        sa.Column("expires_us", sa.BigInteger(), nullable=True),
        sa.Column("revoked_us", sa.BigInteger(), nullable=True),
        sa.ForeignKeyConstraint(["user_id"], ["users.id"], name=op.f("fk_tokens_user_id_users")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_tokens")),
        sa.UniqueConstraint("digest", name=op.f("uq_tokens_digest")),
    )
    op.create_index(op.f("ix_tokens_user_id"), "tokens", ["user_id"], unique=False)
    op.create_table(
        "entries",
        sa.Column("recording_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("kind", sa.String(), nullable=False),
        sa.Column("property", sa.String(), nullable=True),
        sa.Column("value", sa.Float(), nullable=True),
        sa.Column("sd", sa.Float(), nullable=True),
        sa.Column("low", sa.Float(), nullable=True),
        sa.Column("high", sa.Float(), nullable=True),
        sa.Column("unit", sa.String(), nullable=True),
        sa.Column("value_si", sa.Float(), nullable=True),
        sa.Column("sd_si", sa.Float(), nullable=True),
        sa.Column("label", sa.String(), nullable=True),
        sa.Column("thing_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("setup_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("gripper", sa.String(), nullable=True),
        sa.Column("recorded_us", sa.BigInteger(), nullable=False),
        sa.ForeignKeyConstraint(["recording_id"], ["recordings.id"], name=op.f("fk_entries_recording_id_recordings")),
        sa.ForeignKeyConstraint(["setup_id"], ["setups.id"], name=op.f("fk_entries_setup_id_setups")),
        sa.ForeignKeyConstraint(["thing_id"], ["things.id"], name=op.f("fk_entries_thing_id_things")),
        sa.PrimaryKeyConstraint("recording_id", "position", name=op.f("pk_entries")),
        sqlite_with_rowid=False,
    )
    op.create_index(
        op.f("ix_entries_property_entries_gripper_entries_recorded_us_entries_recording_id"),
        "entries",
        ["property", "gripper", "recorded_us", "recording_id"],
        unique=False,
    )
    op.create_index(
        op.f("ix_entries_property_entries_label_entries_recorded_us_entries_recording_id"),
        "entries",
        ["property", "label", "recorded_us", "recording_id"],
        unique=False,
        sqlite_where=sa.text("label IS NOT NULL"),
        postgresql_where=sa.text("label IS NOT NULL"),
    )
    op.create_index(
        op.f("ix_entries_property_entries_recorded_us_entries_recording_id"),
        "entries",
        ["property", "recorded_us", "recording_id"],
        unique=False,
    )
    op.create_index(
        op.f("ix_entries_property_entries_thing_id_entries_setup_id_entries_value_si"),
        "entries",
        ["property", "thing_id", "setup_id", "value_si"],
        unique=False,
        sqlite_where=sa.text("value_si IS NOT NULL"),
        postgresql_where=sa.text("value_si IS NOT NULL"),
    )
    op.create_table(
        "episode_steps",
        sa.Column("episode_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("recording_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=True),
        sa.Column("document", sa.Text(), nullable=False),
        sa.ForeignKeyConstraint(["episode_id"], ["episodes.id"], name=op.f("fk_episode_steps_episode_id_episodes")),
        sa.ForeignKeyConstraint(
            ["recording_id"], ["recordings.id"], name=op.f("fk_episode_steps_recording_id_recordings")
        ),
        sa.PrimaryKeyConstraint("episode_id", "position", name=op.f("pk_episode_steps")),
    )
    op.create_index(op.f("ix_episode_steps_recording_id"), "episode_steps", ["recording_id"], unique=False)
    op.create_table(
        "files",
        sa.Column("recording_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("media_type", sa.String(), nullable=False),
        sa.Column("blob", sa.LargeBinary(length=32), nullable=False),
        sa.ForeignKeyConstraint(["recording_id"], ["recordings.id"], name=op.f("fk_files_recording_id_recordings")),
        sa.PrimaryKeyConstraint("recording_id", "position", name=op.f("pk_files")),
    )
    op.create_table(
        "series",
        sa.Column("recording_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("position", sa.Integer(), nullable=False),
        sa.Column("name", sa.String(), nullable=False),
        sa.Column("layout_id", sa.BigInteger().with_variant(sa.Integer(), "sqlite"), nullable=False),
        sa.Column("data", sa.LargeBinary(), nullable=True),
        sa.Column("blob", sa.LargeBinary(length=32), nullable=True),
        sa.ForeignKeyConstraint(["layout_id"], ["layouts.id"], name=op.f("fk_series_layout_id_layouts")),
        sa.ForeignKeyConstraint(["recording_id"], ["recordings.id"], name=op.f("fk_series_recording_id_recordings")),
        sa.PrimaryKeyConstraint("recording_id", "position", name=op.f("pk_series")),
        sqlite_with_rowid=False,
    )


def downgrade() -> None:
    """Drop the tables."""
    op.drop_table("series")
    op.drop_table("files")
    op.drop_index(op.f("ix_episode_steps_recording_id"), table_name="episode_steps")
    op.drop_table("episode_steps")
    op.drop_index(
        op.f("ix_entries_property_entries_thing_id_entries_setup_id_entries_value_si"),
        table_name="entries",
        sqlite_where=sa.text("value_si IS NOT NULL"),
        postgresql_where=sa.text("value_si IS NOT NULL"),
    )
    op.drop_index(op.f("ix_entries_property_entries_recorded_us_entries_recording_id"), table_name="entries")
    op.drop_index(
        op.f("ix_entries_property_entries_label_entries_recorded_us_entries_recording_id"),
        table_name="entries",
        sqlite_where=sa.text("label IS NOT NULL"),
        postgresql_where=sa.text("label IS NOT NULL"),
    )
    op.drop_index(
        op.f("ix_entries_property_entries_gripper_entries_recorded_us_entries_recording_id"), table_name="entries"
    )
    op.drop_table("entries")
    op.drop_index(op.f("ix_tokens_user_id"), table_name="tokens")
    op.drop_table("tokens")
    op.drop_index(op.f("ix_thing_properties_thing_id"), table_name="thing_properties")
    op.drop_table("thing_properties")
    op.drop_table("thing_images")
    op.drop_index(op.f("ix_setup_devices_device_id"), table_name="setup_devices")
    op.drop_table("setup_devices")
    op.drop_index(op.f("ix_recordings_thing_id_recordings_recorded_us_recordings_id"), table_name="recordings")
    op.drop_index(op.f("ix_recordings_setup_id_recordings_recorded_us_recordings_id"), table_name="recordings")
    op.drop_index(op.f("ix_recordings_recorded_us_recordings_id"), table_name="recordings")
    op.drop_index(
        op.f("ix_recordings_owner_recordings_recorded_us_recordings_id"),
        table_name="recordings",
        sqlite_where=sa.text("owner IS NOT NULL"),
        postgresql_where=sa.text("owner IS NOT NULL"),
    )
    op.drop_index(op.f("ix_recordings_gripper_recordings_recorded_us_recordings_id"), table_name="recordings")
    op.drop_table("recordings")
    op.drop_index(op.f("ix_episodes_thing_id"), table_name="episodes")
    op.drop_index(op.f("ix_episodes_started_us"), table_name="episodes")
    op.drop_table("episodes")
    op.drop_index(op.f("ix_audit_thing_id"), table_name="audit")
    op.drop_table("audit")
    op.drop_table("users")
    op.drop_index(op.f("ix_things_merged_into"), table_name="things")
    op.drop_table("things")
    op.drop_table("setups")
    op.drop_table("properties")
    op.drop_table("layouts")
    op.drop_index(op.f("ix_devices_name"), table_name="devices")
    op.drop_table("devices")
