"""A missing sample that a derivative cannot do without is told with its file and line, and the rows that leave it out."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from greybox_torch.data import load_dataset
from greybox_torch.errors import UserError

CARD = """time = "t"
[channels]
u = { column = "u", derivative = 5 }
[[experiment]]
name = "A"
role = "validation"
file = "a.csv"
"""


@pytest.mark.parametrize("top", ["", "resample = 0.02\n", "resample = 0.015\n"])
def test_the_line_and_the_rows(tmp_path: Path, top: str) -> None:
    u = [f"{v:.4f}" if k not in (14, 15, 16) else "" for k, v in enumerate(np.sin(np.arange(40) / 3))]
    (tmp_path / "a.csv").write_text("t,u\n" + "".join(f"{0.01 * k:.2f},{v}\n" for k, v in enumerate(u)))
    (tmp_path / "dataset.toml").write_text(top + CARD)
    with pytest.raises(
        UserError, match=r'derivative: .*a\.csv, line 1[678], column "u", sample 1[456] .* is missing; '
    ) as error:
        load_dataset(tmp_path / "dataset.toml")
    assert str(error.value).endswith("two experiments in place of this one: rows = [0, 14] and rows = [17, 40]")
