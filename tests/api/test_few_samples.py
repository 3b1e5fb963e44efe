"""As many unknowns as samples: the result is written, without a prediction error."""

from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import torch
from rich.console import Console

import greybox_torch as gt


class Wavy(gt.GreyBoxModel):
    """As many parameters as a recording has samples, about."""

    count = 9
    states = [gt.State("angle", "rad", initial="measured")]
    inputs = [gt.Input("push", "rad/s")]
    outputs = [gt.Output("angle", "rad")]
    parameters = [gt.Parameter(f"a{k}", 1.0 + k, unit="1") for k in range(count)]
    ports = []

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        waves = sum(getattr(p, f"a{k}") * torch.cos(k * x.angle) for k in range(self.count))
        return {"angle": u.push * waves - x.angle}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"angle": x.angle}


class Wavier(Wavy):
    """With more of them."""

    count = 11
    parameters = [gt.Parameter(f"a{k}", 1.0 + k, unit="1") for k in range(count)]


@pytest.mark.parametrize("model", [Wavy(), Wavier()])
def test_no_prediction_error_is_told_of_as_many_unknowns_as_samples(
    model: gt.GreyBoxModel, capsys: pytest.CaptureFixture[str]
) -> None:
    """Seen: a division by zero with ten unknowns, "fpe": -3.44 with twelve."""
    signals = np.random.default_rng(1).normal(size=(2, 10))
    recording = gt.Recording.from_arrays("Short", dict(zip(("push", "angle"), signals, strict=True)), sample_time=0.1)
    found = gt.fit(model, gt.DataSet([recording], held_out_by_default=False))
    assert json.loads(found.to_json())["statistics"]["fpe"] is None
    found.show(Console())
    assert "final prediction error: undetermined: no more samples than unknowns" in capsys.readouterr().out
