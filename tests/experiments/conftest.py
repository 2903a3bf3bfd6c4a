import pytest

from palpate import Network, load_network


@pytest.fixture(scope="session")
def household() -> Network:
    """The network that tapes are drawn from."""
    return load_network("household-filled")
