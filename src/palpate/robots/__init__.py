"""Robots: the protocol and its contract test kit; sampled, replayed and made of functions."""
