"""The document of a recording is put together from parts, and is what one call of json gives for all of it."""

import json
from datetime import datetime, timedelta, timezone
from typing import Any

import numpy as np
from hypothesis import given, settings

from palpate.store.content import document, layout_plain, layout_text
from palpate.store.entries import Bound, Distribution
from palpate.store.records import Channel, FileItem, Pose, Recording, Series, ThingRef
from tests.store.made_up import recordings


def written_plainly(value: Any) -> str:
    return json.dumps(value, sort_keys=True, separators=(",", ":"), ensure_ascii=False, allow_nan=False)


@settings(deadline=None)
@given(recordings())
def test_document_is_json_with_sorted_keys(one: Recording) -> None:
    """Read and written again by json alone, a document is the same to the byte."""
    found = document(one)
    assert written_plainly(json.loads(found)) == found


@settings(deadline=None)
@given(recordings())
def test_document_holds_each_series(one: Recording) -> None:
    """Each series stands in the document in order, with its layout and the number of samples of each channel."""
    plain = json.loads(document(one))["series"]
    assert [series["name"] for series in plain] == [series.name for series in one.series]
    for told, series in zip(plain, one.series, strict=True):
        assert told["counts"] == [len(channel.values) for channel in series.channels]
        assert told["channels"] == json.loads(written_plainly(layout_plain(series)))
        assert written_plainly(told["channels"]) == layout_text(series)


def test_digest_of_another_version() -> None:
    """The digest is the one that the first version of the format gave, in which recordings are stored."""
    force = Channel("force", "force", "N", np.arange(6, dtype=">i2").reshape(3, 2), 10)
    width = Channel("width", "length", None, np.arange(3.0), None, np.arange(3.0))
    one = Recording(
        datetime(2024, 5, 1, tzinfo=timezone(timedelta(hours=2))),
        "squeezing",
        ThingRef("ycb", "025_mug"),
        grasp={"z": 1, "a": [True, 0.1]},
        gripper_pose=Pose((1, 2, 3), (1, 0, 0, 0), "base", {"k": "é"}),
        series=(Series("gripper", (force, width)), Series("none", ())),
        files=(FileItem("note.txt", "text/plain", b"x"),),
        entries=(Bound("elasticity", above=95, unit="kPa"), Distribution("material", {"wood": 0.5, "clay": 0.5})),
        log="pressed\n",
        notices=("é",),
    )
    assert one.digest == "17085e63def1704bcb2ef3056a189f54fa334134f3dbd7d66dfff8be2a10d54d"
