"""Licences of data, by the names that data sets, citations and repositories use for them."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["Licence", "licence_named"]


@dataclass(frozen=True)
class Licence:
    """A licence by its names.

    Attributes
    ----------
    name
        Its SPDX identifier; where it has none, what it was called.
    hub
        What the Hugging Face Hub calls it: ``other`` where it has no name of its own there.
    listed
        Whether `name` is an SPDX identifier.
    """

    name: str
    hub: str = "other"
    listed: bool = False

    @property
    def reference(self) -> str:
        """Where it can be read, or its name where that is not known."""
        return f"https://spdx.org/licenses/{self.name}.html" if self.listed else self.name


# SPDX identifiers, and what the Hugging Face Hub calls them where it is not the same in small letters
SHORTENED = {
    "AFL-3.0": None,
    "Apache-2.0": None,
    "BSD-2-Clause": None,
    "BSD-3-Clause": None,
    "C-UDA-1.0": "c-uda",
    "CC-BY-2.0": None,
    "CC-BY-2.5": None,
    "CC-BY-3.0": None,
    "CC-BY-4.0": None,
    "CC-BY-NC-2.0": None,
    "CC-BY-NC-3.0": None,
    "CC-BY-NC-4.0": None,
    "CC-BY-NC-ND-3.0": None,
    "CC-BY-NC-ND-4.0": None,
    "CC-BY-NC-SA-2.0": None,
    "CC-BY-NC-SA-3.0": None,
    "CC-BY-NC-SA-4.0": None,
    "CC-BY-ND-4.0": None,
    "CC-BY-SA-3.0": None,
    "CC-BY-SA-4.0": None,
    "CC0-1.0": None,
    "CDLA-Permissive-1.0": None,
    "CDLA-Permissive-2.0": None,
    "CDLA-Sharing-1.0": None,
    "MIT": None,
    "ODC-By-1.0": "odc-by",
    "ODbL-1.0": "odbl",
    "PDDL-1.0": "pddl",
    "Unlicense": None,
}


def licence_named(text: str) -> Licence:
    """The licence of a name, however it is written; one that is not known keeps its name.

    Examples
    --------
    >>> licence_named("CC BY 4.0")
    Licence(name='CC-BY-4.0', hub='cc-by-4.0', listed=True)
    >>> licence_named("for our lab alone")
    Licence(name='for our lab alone', hub='other', listed=False)
    """
    return KNOWN.get(_plain(text), Licence(text.strip()))


def _plain(text: str) -> str:
    return "".join(letter for letter in text.casefold() if letter.isalnum())


KNOWN = {_plain(name): Licence(name, hub or name.lower(), listed=True) for name, hub in SHORTENED.items()}
