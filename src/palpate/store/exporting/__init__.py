"""Exports: measurements as tables and data sets that other programs and other people read."""
