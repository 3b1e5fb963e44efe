"""The errors that users meet. `str(error)` is the whole message: what is wrong, where, and what is expected instead."""

from __future__ import annotations


class GreyboxError(Exception):
    """Base of every error raised on purpose by this package."""


class UserError(GreyboxError):
    """The user's input is at fault: a file, a field, an option or an argument. The command line exits with 2."""


class NumericalError(GreyboxError):
    """The numbers failed: overflow, NaN, rank deficiency. The command line exits with 3."""
