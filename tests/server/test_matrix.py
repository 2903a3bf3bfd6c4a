"""Every route, asked by everybody for what is private and ann's: one that is not in the table is a failure."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any
from uuid import uuid4

import pytest
from fastapi.routing import iter_route_contexts
from fastapi.testclient import TestClient
from sqlalchemy import update

from palpate.server.app import application
from palpate.server.security.accounts import Role, add_user
from palpate.server.security.tokens import issue, revoke, tokens
from palpate.store import schema
from palpate.store.opening import open_store
from palpate.store.store import Store
from tests.server.conftest import SMALL
from tests.server.packages import package
from tests.server.test_authorisation import World, world

__all__ = ["world"]

API = "/api/v1"
PEOPLE = ("anonymous", "reader", "bob", "curator", "expired", "revoked", "ann", "admin")
"""Those who may change least come first."""
ENTRY = {"kind": "value", "property": "mass", "value": 1.0, "unit": "g"}
WHO_MAY = {
    # anonymous, reader, bob, curator, expired, revoked, ann, admin
    "GET /api/v1/openapi.json": "........",
    "GET /health": "........",
    "GET /metrics": "1...11..",
    "PATCH /api/v1/objects/{dataset}/{name}": "134411..",
    "PUT /api/v1/objects/{dataset}/{name}/known": "134411..",
    "DELETE /api/v1/objects/{dataset}/{name}/known": "134411..",
    "POST /api/v1/objects/{dataset}/{name}/merge": "1344113.",
    "POST /api/v1/objects/{dataset}/{name}/split": "134411..",
    "POST /api/v1/objects/{dataset}/{name}/undo": "134411..",
    "GET /api/v1/objects/{dataset}/{name}/history": "134411..",
    "GET /api/v1/objects": "....11..",
    "GET /api/v1/objects/{dataset}/{name}": "444411..",
    "GET /api/v1/objects/{dataset}/{name}/images/{position}": "444411..",
    "GET /api/v1/recordings": "....11..",
    "GET /api/v1/recordings/{key}": "444411..",
    "GET /api/v1/recordings/{key}/files": "444411..",
    "GET /api/v1/recordings/{key}/files/{position}": "444411..",
    "GET /api/v1/recordings/{key}/package": "444411..",
    "GET /api/v1/recordings/{key}/log": "444411..",
    "PUT /api/v1/recordings/{key}": "13..11..",
    "POST /api/v1/recordings/known": "13..11..",
    "POST /api/v1/recordings": "13..11..",
    "GET /api/v1/recordings/{key}/series": "444411..",
    "GET /api/v1/recordings/{key}/series/{position}": "444411..",
    "GET /api/v1/recordings/{key}/series/{position}/channels/{channel}/sound": "444411..",
    "GET /api/v1/entries": "....11..",
    "GET /api/v1/properties": "....11..",
    "GET /api/v1/devices": "....11..",
    "GET /api/v1/setups": "....11..",
    "GET /api/v1/setups/{digest}": "444411..",
    "GET /api/v1/episodes": "....11..",
    "GET /api/v1/episodes/{id}": "444411..",
    "PUT /api/v1/episodes/{id}": "13..11..",
    "PUT /api/v1/episodes/{id}/lines/{position}": "134411..",
    "PATCH /api/v1/recordings/{key}": "134411..",
    "POST /api/v1/recordings/{key}/undo": "134411..",
    "GET /api/v1/recordings/{key}/history": "134411..",
    "PATCH /api/v1/episodes/{id}": "134411..",
    "POST /api/v1/episodes/{id}/undo": "134411..",
    "GET /api/v1/episodes/{id}/history": "134411..",
    "GET /api/v1/users": "1333113.",
    "GET /api/v1/tokens": "1...11..",
    "POST /api/v1/tokens": "1...11..",
    "GET /account": "1...11..",
    "POST /account": "1...11..",
    "GET /users": "1333113.",
    "POST /users": "1333113.",
    "DELETE /api/v1/tokens/{id}": "144411..",
    "POST /rest/measurements/": "33333333",
    "POST /rest/entries/": "33333333",
    "POST /rest/grasp_proposals/": "33333333",
    "GET /bundles/bokeh.min.js": "........",
    "GET /benchmark": "....11..",
    "GET /benchmark/errors.csv": "....11..",
    "GET /benchmark/errors.json": "....11..",
    "GET /compare/curves.json": "444411..",
    "GET /": "....11..",
    "GET /enter": "33333333",
    "POST /example": "3333113.",
    "GET /objects/{dataset}/{name}/edit": "134411..",
    "POST /objects/{dataset}/{name}/edit": "134411..",
    "GET /objects": "....11..",
    "GET /objects/{dataset}/{name}": "444411..",
    "GET /objects/{dataset}/{name}/plot.json": "444411..",
    "GET /objects/{dataset}/{name}/beliefs.json": "44441144",
    "GET /recordings": "....11..",
    "GET /recordings/{key}": "444411..",
    "GET /recordings/{key}/series/{position}/squeeze.json": "44441144",
    "GET /recordings/{key}/series/{position}/channels/{channel}/plot.json": "444411..",
    "GET /recordings/{key}/series/{position}/channels/{channel}/spectrogram.png": "444411..",
    "GET /recordings/{key}/files/{place}/plot.json": "44441144",
    "GET /recordings/{key}/files/{place}/spectrogram.png": "44441144",
    "GET /devices": "....11..",
    "GET /devices/{digest}": "444411..",
    "GET /devices/{digest}/errors.json": "44441144",
    "GET /setups/{digest}": "444411..",
    "GET /compare": "....11..",
    "GET /compare/plot.json": "....11..",
    "GET /compare/table.csv": "....11..",
    "GET /episodes/{id}/events": "444411..",
    "GET /episodes": "....11..",
    "GET /episodes/{id}": "444411..",
    "GET /guides": "....11..",
    "GET /guides/{name}": "....11..",
    "GET /login": "....11..",
    "POST /login": "........",
    "POST /logout": "........",
    "GET /login/provider": "44444444",
    "GET /login/provider/back": "44444444",
    "POST /recordings/{id}/sharing": "134411..",
    "POST /episodes/{id}/sharing": "134411..",
    "GET /upload": "13..11..",
    "POST /upload": "13..11..",
    "POST /upload/one": "13..11..",
    "GET /upload/{id}": "13441144",
    "GET /upload/{id}/recordings/{digest}/files/{place}": "13441144",
    "GET /upload/{id}/recordings/{digest}/series/{position}/channels/{channel}/sound": "13441144",
    "POST /upload/{id}/keep": "13441144",
    "GET /upload/{id}/kept": "13441144",
    "POST /upload/{id}/cancel": "13441144",
}
"""By person: a full stop where it is done, or would be if it were right, and else the end of 401, 403 or 404.

What comes by the old program's addresses is refused here to everybody, as it is neither over TLS nor from this
computer; and beliefs, squeezes and true values are none of this recording's.
"""


@pytest.fixture
def store(tmp_path: Path) -> Iterator[Store]:
    with open_store(tmp_path / "store.sqlite", durable=False) as found:
        yield found


def routes(app: Any) -> list[tuple[str, str]]:
    """All routes with their methods."""
    found = [(method, one) for one in iter_route_contexts(app.routes) for method in getattr(one, "methods", None) or ()]
    return [(method, str(getattr(one, "path", ""))) for method, one in found if method != "HEAD"]


@pytest.fixture
def everybody(world: World) -> World:
    """With somebody who owns other things, and with tokens of the administrator that do not hold any more."""
    add_user(world.store, "bob", Role.OWNER)
    secrets = {"bob": issue(world.store, "bob"), "expired": issue(world.store, "admin", days=1e-9)}
    secrets["revoked"] = issue(world.store, "admin")
    revoke(world.store, tokens(world.store, "admin")[-1].id)
    world.headers |= {name: {"Authorization": f"Bearer {secret}"} for name, secret in secrets.items()}
    return world


def test_each_route_is_for_whom_it_is_meant(everybody: World, monkeypatch: pytest.MonkeyPatch) -> None:
    """What is private is not there for others, what changes something needs a role, and a token that ended is told."""
    # thousands of recordings, which nobody looks at here
    monkeypatch.setattr("palpate.server.pages.home.add_example", lambda _: None)
    # of a stream that goes on the beginning is enough
    monkeypatch.setattr("palpate.server.pages.live.LONGEST_S", 0.0)
    app = application(everybody.store, SMALL)
    with TestClient(app, raise_server_exceptions=False) as client:
        found = {
            f"{method} {path}": "".join(asked(client, everybody, person, method, path) for person in PEOPLE)
            for method, path in routes(app)
        }
    assert found == WHO_MAY


def asked(client: TestClient, world: World, person: str, method: str, path: str) -> str:
    """A full stop where it was done or would have been, and else the last digit of the status."""
    recording, episode = world.recordings["private"], world.episodes["private"]
    if "{dataset}" in path:
        # an owner changes what they alone have described
        others = update(schema.audit).where(schema.audit.c.who == "admin").values(undone_us=1)
        with world.store.engine.begin() as connection:
            connection.execute(others)
    if "/tokens/" in path:
        issue(world.store, "ann")
    ids = {
        "episodes": episode.id,
        "recordings": recording.id,
        "upload": uuid4(),
        "tokens": tokens(world.store, "ann")[-1].id,
    }
    parts = {
        "dataset": "lab",
        "name": "marker-private" if "{dataset}" in path else "api",
        "key": recording.digest if method == "PUT" else str(recording.id),
        "id": next((id for part, id in ids.items() if f"/{part}/" in path), None),
        "position": 0,
        "place": 0,
        "channel": 0,
        "digest": recording.setup.digest if "setups" in path else world.devices["private"],
    }
    query, sent = SENT.get(f"{method} {path}", ("", {}))
    if callable(sent):
        sent = sent(world)
    address = path.format(**parts) + query.format(**{"recording": recording.id})
    headers = {**world.headers[person], "Origin": "http://testserver"}
    found = client.request(method, address, headers=headers, follow_redirects=False, **sent)
    assert found.status_code < 500, (person, method, path, found.text)
    return {401: "1", 403: "3", 404: "4"}.get(found.status_code, ".")


SENT: dict[str, tuple[str, Any]] = {
    f"PATCH {API}/objects/{{dataset}}/{{name}}": ("", {"json": {"maker": "somebody"}}),
    f"PUT {API}/objects/{{dataset}}/{{name}}/known": ("", {"json": {"entry": ENTRY, "source": "me"}}),
    f"DELETE {API}/objects/{{dataset}}/{{name}}/known": ("?property=mass", {}),
    f"POST {API}/objects/{{dataset}}/{{name}}/merge": ("", {"json": {"dataset": "lab", "name": "marker-shared"}}),
    f"PUT {API}/recordings/{{key}}": ("", lambda world: {"content": package(world.recordings["private"])}),
    f"POST {API}/recordings/known": ("", {"json": {"digests": []}}),
    f"PUT {API}/episodes/{{id}}": (
        "",
        {"json": {"started_at": "2024-05-01T00:00:00Z", "thing": {"dataset": "a", "id": "b"}, "header": {}}},
    ),
    f"PUT {API}/episodes/{{id}}/lines/{{position}}": ("", {"json": {"record": {"stop": "enough"}}}),
    f"PATCH {API}/recordings/{{key}}": ("", {"json": {"visibility": "private"}}),
    f"PATCH {API}/episodes/{{id}}": ("", {"json": {"visibility": "private"}}),
    f"POST {API}/tokens": ("", {"json": {}}),
    "POST /account": ("", {"data": {"do": "token", "role": "reader", "days": "1"}}),
    "POST /users": ("", {"data": {"do": "role", "name": "bob", "role": "owner"}}),
    "POST /objects/{dataset}/{name}/edit": ("", {"data": {"do": "describe", "maker": "me"}}),
    "POST /recordings/{id}/sharing": ("", {"data": {"visibility": "private"}}),
    "POST /episodes/{id}/sharing": ("", {"data": {"visibility": "private"}}),
    "GET /objects/{dataset}/{name}/plot.json": ("?property=mass", {}),
    "GET /objects/{dataset}/{name}/beliefs.json": ("?property=mass", {}),
    "GET /devices/{digest}/errors.json": ("?property=mass", {}),
    "GET /compare/curves.json": ("?recording={recording}", {}),
}
