"""A digest of a network's model, so that a log can say which network it was made with."""

from __future__ import annotations

import ast
import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from hashlib import sha256
from typing import Any

import numpy as np

from palpate.network.model import Network

__all__ = ["digest"]

NO_MODEL = ("description", "text")


def digest(network: Network) -> str:
    """Return 16 hexadecimal digits of the SHA-256 of the properties and the actions.

    Two networks that give the same beliefs and gains for the same evidence have the same digest:
    name, descriptions and known objects do not count.
    """
    model = [_plain(network.properties), _plain(network.actions)]
    return sha256(json.dumps(model).encode()).hexdigest()[:16]


def _plain(value: Any) -> Any:
    if is_dataclass(value):
        kept = {field.name: getattr(value, field.name) for field in fields(value) if field.name not in NO_MODEL}
        # a bias came later: networks without one keep the digest that older logs have
        if kept.get("bias") == 0:
            del kept["bias"]
        return [type(value).__name__, *([name, _plain(item)] for name, item in kept.items())]
    if isinstance(value, Mapping):
        return [[key, _plain(item)] for key, item in value.items()]
    if isinstance(value, np.ndarray):
        return [list(value.shape), [float(item).hex() for item in value.ravel()]]
    if isinstance(value, ast.AST):
        return ast.dump(value)
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return float(value).hex() if isinstance(value, float) else value
