"""Of two columns of one encoder, a card takes the one that counts on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import greybox_torch as gt

MODEL = """
from greybox_torch import GreyBoxModel, Input, Output, Parameter, State


class Motor(GreyBoxModel):
    states, inputs, outputs = [State("motor", "rad")], [Input("current", "A")], [Output("motor", "rad")]
    parameters = [Parameter("k", 1.0, unit="rad/(A s)")]

    def derivative(self, x, u, p, port):
        return {"motor": p.k * u.current}

    def output(self, x, u, p):
        return {"motor": x.motor}
"""


@pytest.mark.parametrize(("together", "expected"), [(True, "2*pi*motor_counts/65536"), (False, "motor_raw")])
def test_the_column_that_counts_on(tmp_path: Path, together: bool, expected: str) -> None:
    """Seen: the raw angle of 14 bits was taken, beside the same counts with the turns added up."""
    time = 0.001 * np.arange(4000)
    counts = np.round(40000 * np.sin(time)) + 3907
    other = counts if together else 2.0 * counts  # of another encoder
    rows = np.column_stack([time, np.cos(time), (counts - 3907) % 16384, other])
    names = "t,current,motor_raw,motor_counts"
    np.savetxt(tmp_path / "run.csv", rows, "%.6g", ",", header=names, comments="")
    (tmp_path / "motor.py").write_text(MODEL)
    text = gt.card([tmp_path / "run.csv"], f"{tmp_path / 'motor.py'}:Motor").text
    (line,) = [line for line in text.splitlines() if line.lstrip("# ").startswith("motor =")]
    assert f' = "{expected}"' in line
