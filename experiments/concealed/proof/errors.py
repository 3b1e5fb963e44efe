"""The one error of the proof. `str(error)` is the whole message."""

from __future__ import annotations


class ProofError(Exception):
    """The protocol is violated, or what was asked cannot be done: what was found, and what is expected. The command exits with 2."""
