"""The state through which a change of a coupling's deflection acts, where there is one."""

from __future__ import annotations

from typing import Any

import pytest
import torch

from greybox_torch.estimate.shifted_states import shifted_state
from greybox_torch.mechanisms import shift
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State


class TwoMasses(GreyBoxModel):
    """Two masses with positions of their own; the coupling's deflection is a function of both."""

    states = [State(name) for name in ("q", "r", "v", "w")]
    inputs = [Input("force", "N")]
    outputs = [Output("v")]
    parameters = [Parameter("k", 50.0), Parameter("g_q", 0.0), Parameter("g_r", 0.0)]
    sign = 1.0

    def __init__(self, sign: float = 1.0, scale: float = 1.0) -> None:
        self.sign, self.scale = sign, scale
        self.ports = [
            Body("first", speed="v", position="q"),
            Coupling(
                "spring",
                deflection=lambda x, u, p: scale * sign * (x.q - x.r),
                rate=lambda x, u, p: scale * sign * (x.v - x.w),
            ),
        ]
        super().__init__()

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        spring = p.k * (x.q - x.r) + 0.1 * (x.v - x.w) + self.sign * port.spring
        fall = p.g_q * torch.sin(x.q)
        return {"q": x.v, "r": x.w, "v": u.force - spring - fall + port.first, "w": spring - p.g_r * torch.sin(x.r)}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"v": x.v}


@pytest.mark.parametrize(
    ("sign", "gravity", "expected"),
    [
        (1.0, (0.0, 0.0), "+q"),
        (-1.0, (0.0, 0.0), "-q"),
        (1.0, (2.0, 0.0), "-r"),  # moving q would change the weight too
        (-1.0, (2.0, 0.0), "+r"),
        (1.0, (2.0, 2.0), ""),
    ],
)
def test_shifted_state_of_a_deflection_that_is_a_function(problem_of, sign, gravity, expected) -> None:
    model = TwoMasses(sign)
    problem = problem_of(model, g_q=gravity[0], g_r=gravity[1])
    assert shifted_state(model, problem, model.ports[1]) == expected


class Geared(TwoMasses):
    """Its first mass turns ``ratio`` times for one turn at the spring; the second one's weight depends on its position."""

    def __init__(self, ratio: Any) -> None:
        super().__init__()
        self.ratio = ratio
        self.ports = [
            Body("first", speed="v", position="q"),
            Coupling("spring", deflection=self.bent, rate=lambda x, u, p: x.v / ratio(p) - x.w),
        ]

    def bent(self, x: Any, u: Any, p: Any) -> Any:
        return x.q / self.ratio(p) - x.r

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        spring = p.k * self.bent(x, u, p) + port.spring
        fall = p.g_r * torch.sin(x.r)
        return {"q": x.v, "r": x.w, "v": u.force - spring / self.ratio(p) + port.first, "w": spring - fall}


def test_the_motor_side_of_a_gear_is_moved_by_the_ratio(problem_of) -> None:
    """Seen: a strain-wave gear between the angles of motor and joint, whose kinematic error was not offered (no answer)."""
    model = Geared(lambda p: 100.0)
    assert shifted_state(model, problem_of(model, g_r=2.0), model.ports[1]) == "+100.0*q"
    assert shifted_state(model, problem_of(model), model.ports[1]) == "-r", "where both will do"


def test_a_ratio_that_is_estimated_is_not_relied_on(problem_of) -> None:
    model = Geared(lambda p: 2.0 * p.k)
    problem = problem_of(model, g_r=2.0)
    assert shifted_state(model, problem, model.ports[1]) == ""
    assert shifted_state(model, problem.fixed, model.ports[1]) == "+100.0*q"


class Twisted(TwoMasses):
    """The first mass's position and the twist are states; the second one's weight depends on what follows from both, ``share`` of it."""

    def __init__(self, share: float = 1.0) -> None:
        super().__init__()
        self.share = share
        self.ports = [
            Body("first", speed="v", position="q"),
            Coupling("spring", deflection="r", rate=lambda x, u, p: x.v - x.w),
        ]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        spring = p.k * x.r + port.spring
        weight, fall = p.g_r * torch.sin(self.share * x.q - x.r), p.g_q * torch.sin(x.q)
        return {"q": x.v, "r": x.v - x.w, "v": u.force - spring - fall + port.first, "w": spring - weight}


@pytest.mark.parametrize(
    ("share", "gravity", "expected"),
    [(1.0, (0.0, 0.0), "+r"), (1.0, (0.0, 2.0), "+r+q"), (0.01, (0.0, 2.0), "+r+100.0*q"), (1.0, (2.0, 2.0), "")],
    ids=["no weight", "weight of the link", "behind a gear", "weights of both"],
)
def test_two_states_move_where_a_third_angle_follows_from_them(problem_of, share, gravity, expected) -> None:
    """Seen: a wrist whose cables hold the link: its harmonic drive's error was not offered, and two ripples were told (0.85 each)."""
    model = Twisted(share)
    problem = problem_of(model, g_q=gravity[0], g_r=gravity[1])
    found = shifted_state(model, problem, model.ports[1])
    assert shift.read(found) == pytest.approx(shift.read(expected))


@pytest.mark.parametrize("per_deflection", [1.0, -1.0, 100.0, -0.025, 1e-5])
def test_what_is_written_is_read(per_deflection: float) -> None:
    states = {"motor.angle": per_deflection, "twist_2": -1.0}
    assert shift.read(shift.written(states)) == states
    assert shift.read("") == {} and shift.written({}) == ""


@pytest.fixture
def problem_of(data_set):
    from greybox_torch.estimate.problem import make_problem

    def make(model: GreyBoxModel, **values: float):
        t = torch.arange(50).numpy() * 0.01
        dataset = data_set({"force": "N", "v": ""}, [{"force": t, "v": 0 * t}])
        return make_problem(dataset, model, dataset.recordings, values=values)

    return make
