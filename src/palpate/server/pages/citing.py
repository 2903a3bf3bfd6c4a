"""How a recording is cited."""

from __future__ import annotations

from palpate.store.parts import Head

__all__ = ["citation"]


def citation(head: Head, root: str) -> str:
    """One sentence for a list of references: who, what, when, under which licence, and how to know it for the same."""
    plain, thing = head.document, head.thing
    name = f"{thing.common_name} ({thing.dataset}/{thing.id})" if thing.common_name else f"{thing.dataset}/{thing.id}"
    licence = plain["licence"] or "not stated"
    return (
        f"{plain['owner'] or 'Owner not stated'}. {plain['action'].capitalize()} of {name}, recorded on "
        f"{head.recorded_at:%Y-%m-%d}. Data set {thing.dataset}, Palpate recording {head.id}, SHA-256 {head.digest}. "
        f"Licence: {licence}. {root}/recordings/{head.id}"
    )
