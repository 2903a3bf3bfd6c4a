"""The steps; each can be undone."""
