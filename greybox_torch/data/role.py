"""What an experiment is for."""

from __future__ import annotations

from typing import Any, Literal, get_args

from greybox_torch.errors import UserError

Role = Literal["estimation", "validation"]
"""Parameters are estimated from an experiment, or results are judged on it."""


def check_role(role: Any, where: str) -> None:
    """Raises UserError, beginning with ``where``, unless ``role`` is one."""
    if role not in get_args(Role):
        raise UserError(f'{where}: found {role!r}, expected "estimation" or "validation"')
