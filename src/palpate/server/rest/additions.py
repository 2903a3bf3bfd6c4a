"""A result that comes later than its measurement: a recording of its own, as what was kept does not change."""

from __future__ import annotations

from typing import Any
from uuid import UUID

from palpate.server.rest.forms import Form
from palpate.server.rest.measurements import entries_given, file_of_json
from palpate.store.errors import StoreError
from palpate.store.importing.json_text import finite
from palpate.store.importing.upload_format import UploadDictionary
from palpate.store.parts import Head, head_of
from palpate.store.records import Recording
from palpate.store.store import Store
from palpate.store.viewing import Viewer

__all__ = ["addition_of_form"]


def addition_of_form(store: Store, viewer: Viewer, form: Form) -> Recording:
    """The recording of a form of ``/rest/entries/``: of the same object, action, time and devices as its measurement.

    Raises
    ------
    LogError, StoreError
        If it holds none, or there is no such measurement to see.
    """
    given = form.content.get("entry") if isinstance(form.content, dict) else None
    if not isinstance(given, dict):
        raise StoreError("entry: expected JSON with an object 'entry' in it")
    head = _measurement(store, viewer, given.get("measurement_id"))
    # an entry has a type, and not always a name of its own
    named = {"name": given.get("name") or given.get("type") or "", **given}
    dictionary = UploadDictionary("form", "", "", {})
    _, entries = entries_given(dictionary, [named], form.notices)
    for key in form.parts:
        form.notices.append(f"the file {key[:100]!r} is left out: send files with the measurement")
    form.notices.append(f"this result was added to the recording {head.id}, which has the signals")
    repository = given.get("repository")
    return Recording(
        recorded_at=head.recorded_at,
        action=head.document["action"],
        thing=head.thing,
        setup=head.setup,
        repository=repository if isinstance(repository, str) else None,
        ground_truth=given.get("ground_truth") is True,
        entries=entries,
        files=(file_of_json("form.json", finite(form.content)),),
        visibility=head.visibility,
        embargoed_until=head.embargoed_until,
    )


def _measurement(store: Store, viewer: Viewer, given: Any) -> Head:
    try:
        found = head_of(store, viewer, UUID(given)) if isinstance(given, str) else None
    except ValueError:
        found = None
    if found is None:
        told = "expected the id that the answer to its upload had"
        raise StoreError(f"entry.measurement_id: found {str(given)[:60]!r}, {told}")
    return found
