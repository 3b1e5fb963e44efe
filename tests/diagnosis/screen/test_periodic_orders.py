from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.screen import periodic_orders
from greybox_torch.diagnosis.screen.candidates import periodic_candidates
from greybox_torch.diagnosis.screen.periodic_orders import scan_orders
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.mechanisms.surroundings import Range
from greybox_torch.model import Body, Coupling


@pytest.mark.parametrize("order", [4.0, 7.3])
def test_order_of_a_ripple_is_found_in_the_data(motor_data, motor, begun, order) -> None:
    data = motor_data(roles=("estimation",), torque=lambda q, v: 0.04 * np.cos(order * q + 0.7))
    search = begun(data, motor)
    shortest = search.plain.fits[0]
    found = scan_orders(search.study, (), search.problem.free_names, [shortest])
    assert found["rotor"][0] == pytest.approx(order, rel=0.01)


def test_order_of_a_friction_that_varies_with_position(motor_data, motor, begun) -> None:
    data = motor_data(roles=("estimation",), torque=lambda q, v: -(0.06 * np.cos(2.6 * q)) * np.tanh(v / 0.1))
    search = begun(data, motor)
    shortest = search.plain.fits[0]
    found = scan_orders(search.study, (), search.problem.free_names, [shortest])
    assert min(abs(o - 2.6) for o in found["rotor"]) < 0.026


def test_model_without_a_body_has_no_orders(data_set, stub) -> None:
    assert scan_orders(stub(problem=stub(model=stub(ports=[])), settings=DiagnosisSettings()), (), (), []) == {}


@pytest.mark.parametrize(("travel", "asked"), [(10.2, ["motor"]), (15.6, ["motor", "drum"])])
def test_a_body_that_moves_otherwise_has_orders_of_its_own(monkeypatch, stub, travel, asked) -> None:
    """Seen: the teeth of a winder's motor, told as another drum's. What turns with the first body repeats at the same orders."""
    travels = {"motor": 10.0, "drum": travel, "shaft": 10.1}
    around = {n: stub(ranges={"position": Range(-t / 2, t / 2, 1.0)}) for n, t in travels.items()}
    ports = [*(Body(n, speed="w") for n in travels), Coupling("belt", deflection="x", rate="v")]
    study = stub(problem=stub(model=stub(ports=ports)), surroundings=around, settings=DiagnosisSettings())
    monkeypatch.setattr(periodic_orders, "_orders_at", lambda study, body, *_: [body.name])
    assert scan_orders(study, (), (), []) == {name: [name] for name in asked}


def test_orders_of_one_body_are_offered_there_alone(motor, begun, motor_data) -> None:
    search = begun(motor_data(roles=("estimation",)), motor)
    known = search.study.shifts, search.study.surroundings
    assert len(periodic_candidates(motor, *known, [3.0])) > 1
    assert [a.named for a in periodic_candidates(motor, *known, [3.0], at="rotor")] == [("rotor", "torque_ripple")]
    assert periodic_candidates(motor, *known, [3.0], at="another") == []
