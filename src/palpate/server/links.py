"""Which answer leads to which request: the links of the OpenAPI document, for programs that follow them."""

from __future__ import annotations

from typing import Any

__all__ = ["add_links"]

API = "/api/v1"
RECORDING = f"{API}/recordings/{{key}}"
EPISODE = f"{API}/episodes/{{id}}"
ABOUT_RECORDING = {
    "recording": f"GET {RECORDING}",
    "files": f"GET {RECORDING}/files",
    "series": f"GET {RECORDING}/series",
    "package": f"GET {RECORDING}/package",
    "log": f"GET {RECORDING}/log",
    "history": f"GET {RECORDING}/history",
    "sharing": f"PATCH {RECORDING}",
    "undo": f"POST {RECORDING}/undo",
}
Links = dict[str, tuple[dict[str, str], dict[str, str]]]


def _first(field: str) -> str:
    return f"$response.body#/items/0/{field}"


def _of_recording(key: str) -> tuple[dict[str, str], dict[str, str]]:
    return ABOUT_RECORDING, {"key": key}


LINKS: Links = {
    f"GET {API}/recordings": _of_recording(_first("id")),
    f"GET {API}/entries": _of_recording(_first("recording")),
    f"GET {RECORDING}": _of_recording("$response.body#/id"),
    f"PUT {RECORDING}": _of_recording("$response.body#/id"),
    f"GET {RECORDING}/files": (
        {"file": f"GET {RECORDING}/files/{{position}}"},
        {"key": "$request.path.key", "position": "0"},
    ),
    f"GET {RECORDING}/series": (
        {"samples": f"GET {RECORDING}/series/{{position}}"},
        {"key": "$request.path.key", "position": "0"},
    ),
    f"GET {API}/episodes": ({"episode": f"GET {EPISODE}"}, {"id": _first("id")}),
    f"PUT {EPISODE}": ({"line": f"PUT {EPISODE}/lines/{{position}}"}, {"id": "$response.body#/id", "position": "1"}),
    f"PUT {EPISODE}/lines/{{position}}": ({"episode": f"GET {EPISODE}"}, {"id": "$response.body#/id"}),
}
"""From an operation to those that its answers lead to by name, and where these find what they need."""


def add_links(document: dict[str, Any]) -> None:
    """Add the links to each answer of a document that says that something was found or done."""
    operations = {
        f"{method.upper()} {path}": operation
        for path, found in document["paths"].items()
        for method, operation in found.items()
    }
    for source, (targets, parameters) in LINKS.items():
        links = {
            name: {"operationId": operations[target]["operationId"], "parameters": parameters}
            for name, target in targets.items()
            if target != source
        }
        for status in {"200", "201"} & operations[source]["responses"].keys():
            operations[source]["responses"][status]["links"] = links
