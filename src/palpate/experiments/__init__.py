"""Experiments: every method on the same taped outcomes, run in many processes, kept as tables."""
