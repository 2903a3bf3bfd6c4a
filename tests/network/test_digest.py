from dataclasses import replace

from palpate.network.digest import digest
from palpate.network.reading import load_network
from palpate.network.sensors import NumberSensor


def test_the_digest_is_of_the_model() -> None:
    """Reading a network twice gives the same digest; its name and objects do not count."""
    network = load_network("household")
    assert digest(network) == digest(load_network("household"))
    assert digest(network) == digest(replace(network, name="other", objects={}, description=""))
    assert len(digest(network)) == 16


def test_the_digest_differs_with_the_figures() -> None:
    """Networks with other figures or other actions have other digests."""
    network = load_network("household")
    weighing = network.action("weighing")
    assert isinstance(weighing.sensor, NumberSensor)
    others = [
        load_network("household-filled"),
        load_network("pantry"),
        network.with_action(replace(weighing, cost_s=16.0)),
        network.with_action(replace(weighing, sensor=replace(weighing.sensor, sd=6.001))),
    ]
    assert len({digest(network), *map(digest, others)}) == 5
