"""All channels of one unit read in another one are asked for together."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from greybox_torch.api.rescaled import MOST_CHANNELS, _changes
from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, State


class Leg(GreyBoxModel):
    """Two joints, and the pressures of two chambers."""

    states = [State("hip", "rad"), State("knee", "rad"), State("p_A", "Pa"), State("p_B", "Pa")]
    inputs = [Input("torque", "N m")]
    outputs = [Output("hip", "rad"), Output("knee", "rad"), Output("p_A", "Pa"), Output("p_B", "Pa")]
    parameters = [Parameter("J", 1.0)]
    ports: list[Body] = []

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"hip": u.torque / p.J, "knee": u.torque, "p_A": 0 * x.p_A, "p_B": torch.zeros_like(x.p_B)}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {name: getattr(x, name) for name in ("hip", "knee", "p_A", "p_B")}


@pytest.mark.parametrize(
    ("names", "times", "question"),
    [
        ({"hip", "knee"}, 57.3, "Is the scale of hip and knee right? With values 57.3 times smaller (rad and deg"),
        ({"p_A", "p_B"}, 1e5, "Is the scale of p_A and p_B right? With values 100000 times as large (Pa and bar"),
    ],
)
def test_channels_of_one_unit_are_changed_together(names: set[str], times: float, question: str) -> None:
    """Seen: a leg's hip and knee in degrees, a fit of 0.6 %, and not a word: with one of them changed nothing is better."""
    together = [change for change in _changes(Leg()) if set(change.read) == names]
    assert sorted(change.factor for change in together) == pytest.approx([1.0 / times, times], rel=1e-3)
    assert any(change.question.startswith(question) for change in together)


def test_many_channels_are_not_changed_together() -> None:
    many = [Output(f"q_{k}", "rad") for k in range(MOST_CHANNELS + 1)]
    model = type("Many", (Leg,), {"outputs": many})()
    assert all(len(change.read) == 1 for change in _changes(model))
