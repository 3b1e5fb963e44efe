"""A recording that is given twice is told: the second was taken for validation."""

from __future__ import annotations

from pathlib import Path

import pytest

import greybox_torch as gt
from greybox_torch.errors import UserError


def test_the_same_file_twice(tmp_path: Path) -> None:
    """Seen: two experiments of the same samples, one to estimate from and one to judge on."""
    file = tmp_path / "run.csv"
    file.write_text("\n".join(["t,u", *(f"{0.1 * k:.1f},{k % 7}" for k in range(40))]))
    with pytest.raises(UserError, match=r"run\.csv twice.*expected each recording once"):
        gt.card([file, tmp_path / "." / "run.csv"])
    assert gt.card([file]).text
