"""The paper's experiments, run again: tasks, tables, claims and their report."""
