"""Grasps that somebody proposes for an object: recordings without a result, as nothing was measured yet."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

from palpate.network.document import is_number
from palpate.server.rest.forms import Form
from palpate.server.rest.measurements import NO_TIME, file_of_json
from palpate.store.errors import StoreError
from palpate.store.importing.json_text import finite
from palpate.store.importing.measurement_parts import thing_of
from palpate.store.records import Device, Recording, Setup

__all__ = ["PROPOSAL", "proposal_of_form"]

PROPOSAL = "grasp proposal"
"""The action of its recording."""
ODD = (
    "this grasp was proposed and not measured: there is no result; it states no units and no frame, and its rotation "
    "has no convention: all is kept as given"
)
AXES = ("x", "y", "z")


def proposal_of_form(form: Form) -> Recording:
    """The recording of a form of ``/rest/grasp_proposals/``; owner and visibility are for others to say.

    Raises
    ------
    StoreError
        If it holds none.
    """
    given = form.content.get("grasp_proposal", form.content) if isinstance(form.content, dict) else None
    if not isinstance(given, dict) or not isinstance(given.get("object_instance"), dict):
        raise StoreError("grasp_proposal: expected JSON with an object 'object_instance' in it")
    for key in form.parts:
        form.notices.append(f"the file {key[:100]!r} is left out: a proposal has none")
    form.notices.extend((ODD, NO_TIME))
    gripper = given.get("gripper")
    gripper = gripper if isinstance(gripper, str) else ""
    if not gripper:
        form.notices.append("no gripper is named for which it is")
    return Recording(
        recorded_at=datetime.now(UTC),
        action=PROPOSAL,
        thing=thing_of(given["object_instance"], form.notices),
        setup=Setup(gripper=Device("gripper", gripper)) if gripper else Setup(),
        grasp=_grasp(given),
        files=(file_of_json("form.json", finite(form.content)),),
    )


def _grasp(given: Mapping[str, Any]) -> Mapping[str, Any]:
    """Place and turn, as lists or as the old program's columns, with all else that is said of it."""
    found: dict[str, Any] = {"proposed": True}
    for name, letter in (("translation", "t"), ("rotation", "r")):
        columns = [given.get(f"{letter}{axis}") for axis in AXES]
        numbers = given.get(name) if name in given else columns
        if not isinstance(numbers, list) or len(numbers) != 3 or not all(is_number(one) for one in numbers):
            raise StoreError(f"grasp_proposal.{name}: expected three numbers, also as {letter}x, {letter}y, {letter}z")
        found[name] = numbers
    for name in ("number_of_fingers", "gripper", "source", "parameters", "successful_measurement"):
        if given.get(name) is not None:
            found[name] = given[name]
    return found
