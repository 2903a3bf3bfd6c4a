"""Plots as SVG that stand in a page, so that they can be read without JavaScript."""
