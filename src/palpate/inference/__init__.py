"""Belief given evidence: the exact engine, its meshes, and what it answers."""
