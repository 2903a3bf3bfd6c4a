import subprocess
import sys
from types import FunctionType, ModuleType

import pytest

import palpate


@pytest.mark.parametrize("name", palpate.__all__)
def test_every_export_is_there(name: str) -> None:
    """Each name of `__all__` can be had, and is no module."""
    assert not isinstance(getattr(palpate, name), ModuleType)
    assert name in dir(palpate)


def test_an_unknown_name_is_an_attribute_error() -> None:
    """A name the package does not have is refused in the usual way."""
    with pytest.raises(AttributeError, match="has no attribute 'exploree'"):
        palpate.__getattr__("exploree")


def test_explore_is_the_function_whoever_imported_the_module() -> None:
    """The module `palpate.explore` does not take the place of the function of that name."""
    program = "import palpate.explore, palpate; from palpate import explore; print(explore is palpate.explore, explore)"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.startswith("True <function explore")
    assert isinstance(palpate.explore, FunctionType)


def test_importing_the_package_imports_no_numerics() -> None:
    """`import palpate` alone is quick: nothing is imported before it is used."""
    program = "import sys, palpate; print([m for m in ('numpy', 'scipy', 'pint', 'rich') if m in sys.modules])"
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout == "[]\n"
