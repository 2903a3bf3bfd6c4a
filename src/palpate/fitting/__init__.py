"""From data to a model: the numbers of a network estimated from objects with known properties and what was measured."""
