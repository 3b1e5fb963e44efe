from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.screen.periodic_orders import scan_orders


@pytest.mark.parametrize("order", [4.0, 7.3])
def test_order_of_a_ripple_is_found_in_the_data(motor_data, motor, begun, order) -> None:
    data = motor_data(roles=("estimation",), torque=lambda q, v: 0.04 * np.cos(order * q + 0.7))
    search = begun(data, motor)
    shortest = search.plain.fits[0]
    found = scan_orders(search.study, (), search.problem.free_names, [shortest])
    assert found[0] == pytest.approx(order, rel=0.01)


def test_order_of_a_friction_that_varies_with_position(motor_data, motor, begun) -> None:
    data = motor_data(roles=("estimation",), torque=lambda q, v: -(0.06 * np.cos(2.6 * q)) * np.tanh(v / 0.1))
    search = begun(data, motor)
    shortest = search.plain.fits[0]
    found = scan_orders(search.study, (), search.problem.free_names, [shortest])
    assert min(abs(o - 2.6) for o in found) < 0.026


def test_model_without_a_body_has_no_orders(data_set, stub) -> None:
    assert scan_orders(stub(problem=stub(model=stub(ports=[])), settings=None, budget=None), (), (), []) == []
