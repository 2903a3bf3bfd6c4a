"""Options that say which recordings a command is about, for every command that asks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import MISSING, dataclass, fields
from functools import wraps
from inspect import Parameter, Signature, signature
from typing import TYPE_CHECKING, Annotated, Any, get_type_hints

import typer

if TYPE_CHECKING:
    from palpate.store.filters import Filter

__all__ = ["Which", "selecting"]

PANEL = "Which recordings"


@dataclass(frozen=True)
class Which:
    """The options as they were typed; each field is one."""

    thing: Annotated[
        str | None, typer.Option("--object", help="Name, common name or alias.", rich_help_panel=PANEL)
    ] = None
    dataset: Annotated[str | None, typer.Option(help="Dataset of the object.", rich_help_panel=PANEL)] = None
    action: Annotated[str | None, typer.Option(help="What the robot did.", rich_help_panel=PANEL)] = None
    property_: Annotated[
        str | None, typer.Option("--property", help="What there is a result of.", rich_help_panel=PANEL)
    ] = None
    label: Annotated[
        list[str] | None,
        typer.Option(help="PROPERTY=LABEL, the most probable one; may be repeated.", rich_help_panel=PANEL),
    ] = None
    device: Annotated[str | None, typer.Option(help="Any device of the setup.", rich_help_panel=PANEL)] = None
    gripper: Annotated[str | None, typer.Option(help="Gripper of the setup.", rich_help_panel=PANEL)] = None
    setup: Annotated[str | None, typer.Option(help="Digest of the setup.", rich_help_panel=PANEL)] = None
    owner: Annotated[str | None, typer.Option(help="Whose they are.", rich_help_panel=PANEL)] = None
    since: Annotated[str | None, typer.Option(help="Recorded at this time or later.", rich_help_panel=PANEL)] = None
    until: Annotated[str | None, typer.Option(help="Recorded before this time.", rich_help_panel=PANEL)] = None
    truth: Annotated[
        bool | None,
        typer.Option("--ground-truth/--no-ground-truth", help="Known to be true, or not.", rich_help_panel=PANEL),
    ] = None
    text: Annotated[str | None, typer.Option(help="Part of a name or notice.", rich_help_panel=PANEL)] = None

    def filter(self) -> Filter:
        """The conditions that they say.

        Raises
        ------
        PalpateError
            If a label or a time cannot be read.
        """
        from palpate.cli.storing import labels_of, moment_of
        from palpate.store.filters import Filter

        return Filter(
            thing=self.thing,
            dataset=self.dataset,
            action=self.action,
            owner=self.owner,
            property=self.property_,
            labels=labels_of(self.label or []),
            device=self.device,
            gripper=self.gripper,
            setup=self.setup,
            since=moment_of("--since", self.since),
            until=moment_of("--until", self.until),
            ground_truth=self.truth,
            text=self.text,
        )


def selecting(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of `Which`, in the place of its parameter ``which``."""
    own = [part for part in signature(command, eval_str=True).parameters.values() if part.name != "which"]
    hints = get_type_hints(Which, include_extras=True)
    shared = [
        Parameter(
            field.name,
            Parameter.KEYWORD_ONLY,
            default=Parameter.empty if field.default is MISSING else field.default,
            annotation=hints[field.name],
        )
        for field in fields(Which)
    ]

    @wraps(command)
    def run(**given: Any) -> None:
        which = Which(**{field.name: given.pop(field.name) for field in fields(Which)})
        command(which=which, **given)

    parts = [*shared, *(part.replace(kind=Parameter.KEYWORD_ONLY) for part in own)]
    run.__signature__ = Signature(parts)  # type: ignore[attr-defined]
    return run
