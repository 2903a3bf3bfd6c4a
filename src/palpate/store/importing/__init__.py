"""Recordings from files that other programs wrote."""
