"""Keeping measurements: recordings, the objects and setups they are of, and the database that holds them."""
