"""Equations are traced without torch's dispatcher, which is slow to begin."""

from __future__ import annotations

import pytest
import torch

from greybox_torch.codegen.lower import lower
from greybox_torch.codegen.trace import Symbol
from greybox_torch.systems import RobotArm, load_model
from tests.codegen.test_routes import lag


@pytest.fixture
def taken_apart(monkeypatch) -> list[str]:
    """The operations that torch takes apart: the first one makes it import its distributed tensors, half a second of every command."""
    found: list[str] = []

    def note(cls, func, types, args=(), kwargs=None):
        found.append(str(func))
        return dispatched(cls, func, types, args, kwargs)

    dispatched = Symbol.__torch_dispatch__.__func__
    monkeypatch.setattr(Symbol, "__torch_dispatch__", classmethod(note))
    return found


@pytest.mark.parametrize("name", ["arm", "motor", "two_link"])
def test_usual_equations_are_traced_without_torch_taking_them_apart(taken_apart, machines, name) -> None:
    classes = {"motor": "Motor", "two_link": "TwoLink"}
    model = RobotArm() if name == "arm" else load_model(f"{machines / name}.py:{classes[name]}")
    assert lower(model, [p.name for p in model.declared_parameters][:1])
    assert not taken_apart


@pytest.mark.parametrize(
    "rate",
    [
        lambda x, u, p: 1.0 - x.level + (2 - p.k),
        lambda x, u, p: 2.0 / (1 + x.level**2) * 2**x.level,
        lambda x, u, p: torch.where((x.level > 0) & (u.flow < 1) | ~(p.k >= 0.5), -x.level, 0.0),
        lambda x, u, p: torch.where(torch.logical_and(x.level > 0, torch.logical_not(u.flow < 1)), x.level, p.k),
        lambda x, u, p: torch.rsub(x.level, 1.0) + torch.sigmoid(x.level) + torch.relu(u.flow),
        lambda x, u, p: torch.tensor(1.0, dtype=torch.float64) - x.level * torch.tensor(2.0, dtype=torch.float64),
    ],
    ids=["from a number", "of a number", "conditions", "logic", "functions", "tensors"],
)
def test_operators_are_traced_without_torch_taking_them_apart(taken_apart, rate) -> None:
    assert lower(lag(rate), ("k",))
    assert not taken_apart
