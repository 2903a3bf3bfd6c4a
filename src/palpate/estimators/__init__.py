"""From raw signals to outcomes: arrays in, an outcome with its uncertainty out; no robot inside."""
