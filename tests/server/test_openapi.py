"""A program that reads the OpenAPI document and tries what it allows and what it does not, as several people.

`PALPATE_TEST_OPENAPI_EXAMPLES` is how many requests it makes up for each operation, person and way: a few in continuous
integration, and hundreds for a long look.
"""

import os
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.errors import Unsatisfiable

from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue
from palpate.server.settings import Settings
from palpate.store.describing import change_thing, keep_image
from palpate.store.keeping_episodes import put_episode
from palpate.store.opening import open_store
from palpate.store.records import Recording
from tests.server.test_authorisation import PNG, VISIBILITIES, made
from tests.store.made_up import made_episode

schemathesis = pytest.importorskip("schemathesis", reason="schemathesis is not installed")
from schemathesis.core.failures import FailureGroup  # noqa: E402 - only where it is installed
from schemathesis.generation import GenerationMode  # noqa: E402
from schemathesis.python import asgi  # noqa: E402
from schemathesis.specs.openapi import checks  # noqa: E402

EXAMPLES = int(os.environ.get("PALPATE_TEST_OPENAPI_EXAMPLES", "4"))
PEOPLE = {"anonymous": None, "ann": Role.OWNER, "admin": Role.ADMIN}
SECRET = "marker-private"
CHECKS = [
    schemathesis.checks.not_a_server_error,
    checks.status_code_conformance,
    checks.content_type_conformance,
    checks.response_headers_conformance,
    checks.response_schema_conformance,
    checks.negative_data_rejection,
    checks.unsupported_method,
    checks.allow_header_conformance,
    checks.ignored_auth,
]
EXCEPT = {
    # each line has an answer of its own
    checks.negative_data_rejection: {"POST /api/v1/recordings"},
    # `known` could be the id of a recording: 404
    checks.unsupported_method: {"POST /api/v1/recordings/known"},
    checks.allow_header_conformance: {"POST /api/v1/recordings/known"},
}
QUIET = settings(
    max_examples=EXAMPLES, derandomize=True, database=None, deadline=None, suppress_health_check=list(HealthCheck)
)


@schemathesis.serializer("application/x-ndjson", "application/zip")
def as_it_is(_: Any, sent: Any) -> bytes:
    return sent if isinstance(sent, bytes) else str(sent).encode("utf-8", "replace")


class Tried:
    """A store with something of everything that is private, for the lab and public, and who asks for it."""

    def __init__(self, folder: Path) -> None:
        self.store = open_store(folder / "store.sqlite", durable=False)
        self.recordings = {name: made(name) for name in VISIBILITIES}
        self.headers: dict[str, dict[str, str]] = {"anonymous": {}}
        for recording in self.recordings.values():
            self._put(recording)
        for name, role in PEOPLE.items():
            if role is not None:
                add_user(self.store, name, role)
                self.headers[name] = {"Authorization": f"Bearer {issue(self.store, name)}"}
        self.app: Any = application(self.store, Settings(requests_per_s=None))
        self.schema = schemathesis.openapi.from_asgi("/api/v1/openapi.json", self.app)

    def _put(self, recording: Recording) -> None:
        self.store.put(recording)
        put_episode(self.store, made_episode(recording, visibility=recording.visibility, owner="ann", stop="done"))
        image = keep_image(self.store, f"{recording.thing.id}.png", "image/png", PNG)
        change_thing(self.store, recording.thing, lambda thing: thing.showing(image))

    def addresses(self, path: str) -> list[dict[str, Any]]:
        """Parts of an address that lead to something, of each visibility."""
        places = {"position": 0, "channel": 0}
        things = [{"dataset": "lab", "name": one.thing.id} for one in self.recordings.values()]
        if "{dataset}" in path:
            return [{**one, **places} for one in things]
        if "/setups/" in path:
            return [{"digest": one.setup.digest} for one in self.recordings.values()]
        recordings = self.recordings.values()
        return [{"key": key, **places} for one in recordings for key in (str(one.id), one.digest)]


@pytest.fixture(scope="module")
def tried(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Tried]:
    found = Tried(tmp_path_factory.mktemp("openapi"))
    yield found
    asgi.shutdown_lifespans()


@pytest.fixture
def untouched(tmp_path: Path) -> Iterator[Tried]:
    """One that others have not changed: what there is to follow would depend on them."""
    yield Tried(tmp_path)
    asgi.shutdown_lifespans()


@pytest.fixture(scope="module")
def cases(tried: Tried) -> list[Any]:
    """The same for everybody, as making them up takes as long as asking."""
    return [case for found in tried.schema.get_all_operations() for case in _cases(tried, found.ok())]


@pytest.mark.parametrize("person", PEOPLE)
def test_all_answers_are_as_the_document_says(tried: Tried, cases: list[Any], person: str) -> None:
    """No error of the server, no answer in another form, nothing wrong accepted, and nothing private for everybody."""
    faults: dict[str, str] = {}
    with asgi.get_client(tried.app) as client:
        for case in cases:
            fault = _fault(case, client, tried.headers[person])
            if fault is not None:
                faults.setdefault(f"{case.operation.label}: {fault[0]}", fault[1])
    assert not faults, "\n\n".join(f"{name}\n{text}" for name, text in faults.items())


@pytest.mark.parametrize("person", ["anonymous", "ann"])
def test_answers_lead_on(untouched: Tried, person: str) -> None:
    """Who follows links from answer to answer, and changes things on the way, gets answers as the document says."""
    followed: set[tuple[str, int]] = set()
    # whoever takes back the token by which it asks is asked for another one from then on
    schema = untouched.schema.exclude(path_regex="/tokens").exclude(path=["/metrics", "/health"])

    class Following(schema.as_state_machine()):  # type: ignore[misc]
        def get_call_kwargs(self, case: Any) -> dict[str, Any]:
            return {"headers": untouched.headers[person]}

        def before_call(self, case: Any) -> None:
            # what is made up finds nothing to follow; it is tried above
            if case.method == "GET" and not case.path_parameters:
                case.query = {}

        def validate_response(self, response: Any, case: Any, **_: Any) -> None:
            followed.add((case.operation.label, response.status_code))
            wanted = [check for check in STATEFUL if case.operation.label not in EXCEPT.get(check, ())]
            case.validate_response(response, checks=wanted, headers=untouched.headers[person])
            if person == "anonymous" and SECRET.encode() in response.content:
                assert SECRET in _asked(response), f"leak: {response.request.url}: {response.content[:500]!r}"

    Following.run(settings=settings(QUIET, max_examples=5 * EXAMPLES, stateful_step_count=10))
    reached = {label for label, status in followed if status == 200}
    assert any(label.startswith("GET /api/v1/recordings/{key}") for label in reached), sorted(followed)
    assert any("{id}" in label or "{dataset}" in label for label in reached), sorted(followed)


STATEFUL = [one for one in CHECKS if one not in (checks.ignored_auth, checks.negative_data_rejection)]
STATEFUL += [checks.use_after_free, checks.ensure_resource_availability]


def _cases(tried: Tried, operation: Any) -> list[Any]:
    """Those at the edges of what is allowed, and some at random; the latter often of what is there."""
    cases = list(
        tried.schema.iter_coverage_cases(
            operation,
            generation_modes=list(GenerationMode),
            generation_config=tried.schema.config.generation_for(operation=operation),
        )
    )
    real = tried.addresses(operation.path)
    for mode in GenerationMode:

        @QUIET
        @given(operation.as_strategy(generation_mode=mode), st.sampled_from([None, *real]))
        def gather(case: Any, address: dict[str, Any] | None) -> None:
            if address is not None and case.path_parameters:
                case.path_parameters |= {name: address[name] for name in case.path_parameters if name in address}
            cases.append(case)

        # of an operation that takes any text nothing is wrong
        with suppress(*([Unsatisfiable] if mode is GenerationMode.NEGATIVE else [])):
            gather()
    return cases


def _fault(case: Any, client: Any, headers: dict[str, str]) -> tuple[str, str] | None:
    wanted = [check for check in CHECKS if case.operation.label not in EXCEPT.get(check, ())]
    if any(value in ("", None, [], [""], {}) for value in (case.query or {}).values()):
        # what is left empty in a form asks for nothing
        wanted.remove(checks.negative_data_rejection)
    try:
        response = case.call_and_validate(session=client, headers=headers, checks=wanted)
    except FailureGroup as failures:
        return ", ".join(sorted(one.title for one in failures.exceptions)), str(failures)
    if not headers and SECRET.encode() in response.content and SECRET not in _asked(response):
        return "leak", f"{response.request.url}: {response.content[:500]!r}"
    return None


def _asked(response: Any) -> str:
    """The request, which errors repeat in part."""
    body = response.request.body or b""
    return unquote(response.request.url) + (body.decode(errors="replace") if isinstance(body, bytes) else str(body))
