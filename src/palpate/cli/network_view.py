"""A network, and the objects it knows, as tables for the terminal."""

from __future__ import annotations

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from palpate.cli.belief_view import plain_table
from palpate.network.model import Network
from palpate.network.properties import CategoricalProperty, ContinuousProperty, Property
from palpate.network.sensors import ConfusionSensor, Sensor
from palpate.wording import number, plural

__all__ = ["network_tables", "object_table", "sensor_words"]


def network_tables(network: Network) -> RenderableType:
    """Properties and actions of a network, and how many objects it knows."""
    title = Text.assemble((network.name, "bold"), f"  {network.description}" if network.description else "")
    properties = plain_table("property", "given", "is")
    for found in network.properties.values():
        properties.add_row(Text(found.name, style="bold"), *_described(found))
    actions = plain_table("action", "measures", "sensor", "cost", right=(3,))
    for action in network.actions.values():
        sensor = sensor_words(network, action.sensor)
        actions.add_row(Text(action.name, style="bold"), action.sensor.property, sensor, f"{action.cost_s:g} s")
    known = f"{plural(len(network.objects), 'known object')} (palpate explore --list)" if network.objects else ""
    return Group(title, Text(), properties, Text(), actions, Text(), Text(known, style="dim"))


def object_table(network: Network) -> Table:
    """The objects that can be simulated, tricks marked with what they look like."""
    table = plain_table("object", "description", "looks like")
    for known in network.objects.values():
        table.add_row(Text(known.name, style="bold"), known.description, known.looks_like or "")
    return table


def _described(found: Property) -> tuple[str, str]:
    """What a property depends on, and what it can be."""
    if isinstance(found, CategoricalProperty):
        return ", ".join(found.parents), ", ".join(found.states)
    if isinstance(found, ContinuousProperty):
        return ", ".join(found.parents), f"{type(found.family).__name__} [{found.unit}]"
    return ", ".join(found.formula.variables), f"{found.formula.text} [{found.unit}]"


def sensor_words(network: Network, sensor: Sensor) -> str:
    """What a sensor is like."""
    if isinstance(sensor, ConfusionSensor):
        repeats = f", repeats {number(sensor.repeat_probability)}" if sensor.repeat_probability else ""
        return f"{plural(len(sensor.outcomes), 'label')}{repeats}"
    unit = getattr(network.property(sensor.property), "unit", "")
    noise = type(sensor.noise).__name__.removesuffix("Noise")
    parts = [f"{noise}, scale {number(sensor.sd)} {unit}" if sensor.sd else noise]
    if sensor.relative_sd:
        parts.append(f"{number(100 * sensor.relative_sd)} %")
    if sensor.offset_sd:
        parts.append(f"shared offset {number(sensor.offset_sd)} {unit}")
    if sensor.bias:
        parts.append(f"bias {number(sensor.bias)} {unit}")
    if sensor.low > float("-inf"):
        parts.append(f"saturates below {number(sensor.low)} {unit}")
    if sensor.high < float("inf"):
        parts.append(f"saturates above {number(sensor.high)} {unit}")
    return ", ".join(parts)
