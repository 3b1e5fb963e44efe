"""Which bodies of a model have dry friction already."""

from __future__ import annotations

from typing import Any, ClassVar

import pytest
import torch

from greybox_torch.model import Body, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.model.own_friction import dry_friction, has_dry_friction
from greybox_torch.systems import RobotArm


class Drum(GreyBoxModel):
    """A drum with loss, drag and rounded dry friction."""

    states: ClassVar = [State("angle", "rad"), State("speed", "rad/s")]
    inputs: ClassVar = [Input("torque", "N m")]
    outputs: ClassVar = [Output("speed", "rad/s")]
    parameters: ClassVar = [Parameter("F", 0.0), Parameter("b", 1.0), Parameter("c", 0.0)]
    ports: ClassVar = [Body("drum", speed="speed"), Body("shown", speed=lambda x, u, p: x.speed)]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        friction = p.F * torch.tanh(x.speed / 0.05) + p.b * x.speed + p.c * x.speed * x.speed.abs()
        return {"angle": x.speed, "speed": (u.torque - friction + port.drum) / 3.0}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"speed": x.speed}


@pytest.mark.parametrize(
    ("F", "b", "c", "level"),
    [(0.0, 1.0, 0.0, 0.0), (0.0, 0.5, 1.0, -0.4), (0.0, 0.0, 0.0, 0.0), (0.2, 1.0, 0.0, 0.2), (2.0, 1.0, 0.0, 2.0)],
)
def test_dry_friction_is_what_does_not_grow_with_speed(F: float, b: float, c: float, level: float) -> None:
    """Drag, which grows faster than speed, makes it negative."""
    model = Drum()
    drum, shown = model.ports
    assert isinstance(drum, Body) and isinstance(shown, Body)
    assert dry_friction(model, drum, 2.0, {"F": F, "b": b, "c": c}) == pytest.approx(level, abs=5e-3)
    assert dry_friction(model, shown, 2.0, {"F": F, "b": b, "c": c}) == 0.0, "its speed cannot be changed alone"


def test_the_published_arm_has_it_at_its_motor_alone() -> None:
    arm = RobotArm()
    levels = {b.name: dry_friction(arm, b, 60.0, arm.values()) for b in arm.ports if isinstance(b, Body)}
    assert levels["motor"] == pytest.approx(arm.values()["F_c"], rel=0.05)
    assert levels["gearbox"] == pytest.approx(0.0, abs=1e-9) and levels["arm"] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize(
    ("F", "c", "has"), [(0.0, 0.0, False), (0.0, 1.0, False), (0.2, 0.0, True), (0.001, 0.0, False)]
)
def test_whether_a_model_has_any(F: float, c: float, has: bool) -> None:
    values = {"F": F, "b": 1.0, "c": c}
    assert has_dry_friction(Drum(), {"speed": 2.0}, values) is has
    assert not has_dry_friction(Drum(), {"angle": 2.0}, values), "no speed is known"
