"""Experiments: they use the public surface of the package only."""
