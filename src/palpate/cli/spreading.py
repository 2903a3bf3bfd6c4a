"""Options that several commands share, as the fields of one frozen dataclass."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import Field, fields, is_dataclass
from functools import wraps
from typing import Any, get_type_hints

__all__ = ["spread"]


def spread(command: Callable[..., None]) -> Callable[..., None]:
    """Spread each parameter that is a dataclass into its fields, which become the options of a command.

    The fields are annotated as a command's parameters are, and need defaults. The command gets the dataclass whole.

    Examples
    --------
    >>> from dataclasses import dataclass
    >>> @dataclass(frozen=True)
    ... class Page:
    ...     limit: int = 50
    ...     cursor: str | None = None
    >>> @spread
    ... def show(page: Page, verbose: bool = False) -> None:
    ...     print(page)
    >>> list(inspect.signature(show).parameters)
    ['limit', 'cursor', 'verbose']
    >>> show(limit=3)
    Page(limit=3, cursor=None)
    """
    signature = inspect.signature(command, eval_str=True)
    groups: dict[str, Any] = {
        name: one.annotation for name, one in signature.parameters.items() if is_dataclass(one.annotation)
    }

    @wraps(command)
    def gathered(**given: Any) -> None:
        for name, group in groups.items():
            own = {field.name: given.pop(field.name) for field in fields(group) if field.name in given}
            given[name] = group(**own)
        command(**given)

    parameters = [part for one in signature.parameters.values() for part in _parts(one, groups)]
    gathered.__signature__ = signature.replace(parameters=parameters)  # type: ignore[attr-defined]
    gathered.__annotations__ = {one.name: one.annotation for one in parameters}
    return gathered


def _parts(parameter: inspect.Parameter, groups: Mapping[str, Any]) -> Iterator[inspect.Parameter]:
    if parameter.name not in groups:
        yield parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY)
        return
    group = groups[parameter.name]
    hints = get_type_hints(group, include_extras=True)
    for field in fields(group):
        yield _parameter(field, hints[field.name])


def _parameter(field: Field[Any], annotation: Any) -> inspect.Parameter:
    return inspect.Parameter(field.name, inspect.Parameter.KEYWORD_ONLY, default=field.default, annotation=annotation)
