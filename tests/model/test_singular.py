"""A mass matrix that is singular where an input is 0 gives no number there, as a division by zero does."""

from __future__ import annotations

import pytest
import torch

import greybox_torch as gt


class Crane(gt.GreyBoxModel):
    """A trolley with a load on a rope, the length of which is recorded."""

    states = [gt.State("angle", "rad", initial="measured"), gt.State("speed", "m/s"), gt.State("rate", "rad/s")]
    inputs = [gt.Input("force", "N"), gt.Input("rope", "m")]
    outputs = [gt.Output("angle", "rad")]
    parameters = [gt.Parameter("M", 7.0, unit="kg", lower=0.5), gt.Parameter("m", 3.0, unit="kg", lower=0.1)]
    ports = [gt.Body("trolley", speed="speed"), gt.Body("load", speed="rate", position="angle")]

    def derivative(self, x, u, p, port):
        both = p.m * u.rope * torch.cos(x.angle)
        rows = [torch.stack([p.M + p.m, both], -1), torch.stack([both, p.m * u.rope**2], -1)]
        weight = 9.81 * p.m * u.rope * torch.sin(x.angle)
        acting = torch.stack([u.force + port.trolley, port.load - weight], -1)
        trolley, load = self.solved(torch.stack(rows, -2), acting).unbind(-1)
        return {"angle": x.rate, "speed": trolley, "rate": load}

    def solved(self, mass, acting):
        return torch.linalg.solve(mass, acting)

    def output(self, x, u, p):
        return {"angle": x.angle}


class ByInverse(Crane):
    def solved(self, mass, acting):
        return (torch.linalg.inv(mass) @ acting.unsqueeze(-1)).squeeze(-1)


@pytest.mark.parametrize("made", [Crane, ByInverse])
def test_only_its_own_sample_has_no_number(made: type[gt.GreyBoxModel]) -> None:
    model = made()
    x = torch.zeros(3, 2, dtype=torch.float64, requires_grad=True)
    rates = model.rates(x, torch.tensor([[1.0, 1.0], [0.0, 0.9]], dtype=torch.float64), model.physical())
    assert torch.isfinite(rates[1:]).tolist() == [[False, True]] * 2
    assert torch.isfinite(torch.autograd.grad(rates[1:, 1].sum(), x)[0][:, 1]).all()


@pytest.mark.parametrize("made", [Crane, ByInverse])
def test_it_is_a_warning_that_says_what_is_zero(made: type[gt.GreyBoxModel], data_set) -> None:
    """Seen: "raised _LinAlgError … write: equations that raise nothing", and neither `check` nor `simulate` went on."""
    (found,) = [f for f in gt.check(made()).findings if f.level != "note"]
    assert found.level == "warning" and found.line
    assert found.found.endswith(
        "at the start (states at their start values, measured ones and inputs at zero), where rope = 0"
    )
    assert found.write.endswith("a matrix that can be inverted")
    names = {"force": "N", "rope": "m", "angle": "rad"}
    recorded = {"force": [0.1 * k for k in range(20)], "rope": [0.9] * 20, "angle": [0.01 * k for k in range(20)]}
    data = data_set(names, [recorded])
    assert not [f for f in gt.check(made(), data).findings if f.topic in ("numbers", "code")]
    assert gt.simulate(made(), data)


def test_other_errors_of_a_solution_are_told() -> None:
    class Odd(Crane):
        def solved(self, mass, acting):
            return torch.linalg.cholesky(mass - mass) @ acting

    (found,) = [f for f in gt.check(Odd()).findings if f.level == "error"]
    assert "raised _LinAlgError: linalg.cholesky" in found.found and found.line
