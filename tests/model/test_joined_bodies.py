"""Bodies that springs join are one link of a chain; those of joints are several."""

from __future__ import annotations

from typing import Any

import pytest

from greybox_torch.diagnosis.screen.candidates import chain_candidates
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.model.joined_bodies import bodies_apart, joined_bodies, to_ground


def made(*couplings: tuple[str, Any]) -> GreyBoxModel:
    """Four bodies a, b, c, d with an angle each, and couplings by name and rate."""

    class Machine(GreyBoxModel):
        states = [State(f"{kind}_{n}", unit) for n in "abcd" for kind, unit in (("q", "rad"), ("w", "rad/s"))]
        inputs = [Input("torque", "N m")]
        outputs = [Output("q_a", "rad")]
        parameters = [Parameter("J", 0.1, "kg m^2")]
        ports = [
            *(Body(n, speed=f"w_{n}", position=f"q_{n}") for n in "abcd"),
            *(Coupling(name, deflection=lambda x, u, p: x.q_a - x.q_b, rate=rate) for name, rate in couplings),
        ]

        def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
            own = {f"q_{n}": x[f"w_{n}"] for n in "abcd"}
            return own | {f"w_{n}": (u.torque + port[n]) / p.J for n in "abcd"}

        def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
            return {"q_a": x.q_a}

    return Machine()


def between(one: str, other: str) -> Any:
    return lambda x, u, p: x[f"w_{one}"] - x[f"w_{other}"]


@pytest.mark.parametrize(
    ("couplings", "groups"),
    [
        ((), ["a", "b", "c", "d"]),
        ((("s", between("a", "b")),), ["ab", "c", "d"]),
        ((("s", between("a", "c")), ("t", between("b", "d"))), ["ac", "bd"]),
        ((("s", between("d", "b")), ("t", between("b", "a"))), ["abd", "c"]),
        ((("s", between("a", "b")), ("t", between("c", "d")), ("v", between("c", "b"))), ["abcd"]),
        ((("s", "w_a"), ("t", lambda x, u, p: 2.0 * x.w_c)), ["a", "b", "c", "d"]),
    ],
)
def test_bodies_are_in_groups_that_couplings_join(couplings, groups) -> None:
    assert ["".join(body.name for body in group) for group in joined_bodies(made(*couplings))] == groups


@pytest.mark.parametrize(
    ("couplings", "links"),
    [
        ((), ("a", "b", "c", "d")),
        ((("s", between("a", "b")), ("t", between("c", "d"))), ("b", "d")),
        ((("s", between("a", "b")), ("t", between("b", "c")), ("v", between("c", "d"))), None),
    ],
)
def test_of_bodies_that_turn_together_the_last_is_a_link(couplings, links) -> None:
    """Seen: a cable harness on a camera, told as gravity (0.97) of a chain of the motor and the camera that it turns by a spring."""
    model = made(*couplings)
    around = Surroundings({"position": Range(-1.0, 1.0, 0.5)}, {"position": "rad"}, "N m", 0.01)
    found = chain_candidates(model, dict.fromkeys("abcd", around))
    assert [a.mechanism.links for a in found] == ([] if links is None else [links])


def test_bodies_apart_are_those_that_no_coupling_joins() -> None:
    model = made(("s", between("a", "c")))
    apart = {
        body.name: [other.name for other in bodies_apart(model, body)] for body in model.ports if isinstance(body, Body)
    }
    assert apart == {"a": ["b", "d"], "b": ["a", "c", "d"], "c": ["b", "d"], "d": ["a", "c", "b"]}


def test_where_a_coupling_does_not_tell_whom_it_joins_no_body_is_apart() -> None:
    model = made(("s", "w_a"))
    assert [bodies_apart(model, body) for body in model.ports if isinstance(body, Body)] == [[], [], [], []]


def test_what_a_rigid_gear_moves_is_no_other_axis() -> None:
    model = made()
    model.ports = [
        Body("a", speed="w_a", position="q_a"),
        Body("wheel", speed="w_b", position=lambda x, u, p: 3.0 * x.q_a),
        Body("c", speed="w_c", position=lambda x, u, p: x.q_c + x.q_a),
    ]
    apart = {body.name: [other.name for other in bodies_apart(model, body)] for body in model.ports}
    assert apart == {"a": ["c"], "wheel": ["c"], "c": ["a", "wheel"]}


@pytest.mark.parametrize(
    ("rate", "held"),
    [
        ("w_a", "a"),
        (lambda x, u, p: x.w_a, "a"),
        (lambda x, u, p: 2.0 * x.w_a, ""),
        (between("a", "b"), ""),
        (None, ""),
    ],
    ids=["its speed", "the same as a function", "through a gear", "between two", "no rate"],
)
def test_a_coupling_that_deflects_as_one_body_moves_holds_it_to_the_ground(rate, held) -> None:
    model = made(("s", rate))
    (coupling,) = (port for port in model.ports if isinstance(port, Coupling))
    assert "".join(b.name for b in model.ports if isinstance(b, Body) and to_ground(model, coupling, b)) == held
