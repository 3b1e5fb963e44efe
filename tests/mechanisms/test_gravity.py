"""Gravity of one body and of a chain of links."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.gravity import Gravity
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.model import Signals

ANGLE = Surroundings({"position": Range(-1.0, 1.0, 0.5)}, {"position": "rad"}, "N m", 0.01)


def signals(**values: float) -> Signals:
    return Signals("signal", {n: torch.tensor(v, dtype=torch.float64, requires_grad=True) for n, v in values.items()})


def test_one_body_is_as_declared() -> None:
    law, p = Gravity(), Signals("parameter", {"a": torch.tensor(2.0), "b": torch.tensor(0.5)})
    found = law.force(signals(position=0.3), p, Signals("memory", {}))
    np.testing.assert_allclose(found.item(), -(2.0 * np.sin(0.3) + 0.5 * np.cos(0.3)))
    assert law.elsewhere(signals(position=0.3), p, Signals("memory", {})) == {}


def test_torques_of_a_chain_are_the_slopes_of_one_potential() -> None:
    law = Gravity(("first", "second", "third"))
    names = [p.name for p in law.parameters(ANGLE)]
    values = dict(zip(names, (1.3, -0.2, 0.7, 0.4, 0.25, -0.6), strict=True))
    p = Signals("parameter", {n: torch.tensor(v, dtype=torch.float64) for n, v in values.items()})
    s = signals(**{"position@first": 0.4, "position@second": -1.1, "position@third": 0.9})
    angles = torch.cumsum(torch.stack([s[f"position@{n}"] for n in law.links]), 0)
    energy = sum(
        -p[f"a_{n}"] * torch.cos(angle) + p[f"b_{n}"] * torch.sin(angle)
        for n, angle in zip(law.links, angles, strict=True)
    )
    slopes = torch.autograd.grad(energy, [s[f"position@{n}"] for n in law.links])
    found = [
        law.force(s, p, Signals("memory", {})),
        *(law.elsewhere(s, p, Signals("memory", {}))[n] for n in law.links[1:]),
    ]
    np.testing.assert_allclose([f.item() for f in found], [-slope.item() for slope in slopes], rtol=1e-12)


def test_a_chain_is_made_again_from_its_options() -> None:
    law = Gravity(["first", "second"])
    assert Gravity(**law.options()).links == ("first", "second")


@pytest.mark.parametrize(("unit", "said"), [("rad", None), ("", None), ("m", "position is in m")])
def test_weight_goes_with_an_angle(unit: str, said: str | None) -> None:
    """Seen: a constant force on a stage, told as gravity (0.77); the weight of a platform, whose angle is a function of a state in degrees,
    told as a curve (0.97).
    """
    around = Surroundings({"position": Range(-0.2, 0.2, 0.1)}, {"position": unit}, "N", 1e-3)
    found = Gravity().degenerate(around, {"a": 0.1, "b": -2.0}, {})
    assert found is None if said is None else said in str(found)
