"""Curves beside laws: a law hands its force to one, and a finer one begins as the one it refines."""

from __future__ import annotations

import numpy as np
import pytest

from greybox_torch.diagnosis.hypothesis.fit import hypothesis
from greybox_torch.diagnosis.refit.curve import absorbed, finer, laws_on_curve
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.friction import QuadraticDrag
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.mechanisms.varying_friction import FrictionWarmup


def test_a_law_hands_its_force_to_the_curve_beside_it(motor_data, motor, begun) -> None:
    """Without this, a law that only began what the curve completed could not be taken back: the curve alone begins too far away."""
    search = begun(motor_data(torque=lambda q, v: -0.004 * v * abs(v)), motor)
    drag, curve = attach(motor, "rotor", QuadraticDrag()), attach(motor, "rotor", Unknown("speed", 12))
    start = {
        **search.plain.values(),
        "rotor.quadratic_drag.c": 0.004,
        **{f"{curve.prefix}.w_{k}": 0.0 for k in range(12)},
    }
    both = hypothesis(search.problem, (drag, curve), search.surroundings, [start], options=search.study.options)
    assert both is not None
    alone = absorbed(both, drag, search.surroundings)
    assert alone is not None and not any(n.startswith(drag.prefix) for n in alone)
    handed = hypothesis(
        search.problem,
        (curve,),
        search.surroundings,
        [alone],
        options=search.study.options,
        frozen=frozenset(n for n in alone if "w_" in n),
    )
    assert handed is not None and handed.score < both.score + 0.05 < search.plain.score - 0.5
    assert absorbed(both, curve, search.surroundings) is None
    bias = attach(motor, "rotor", ConstantBias())
    beside = hypothesis(search.problem, (bias, curve), search.surroundings, [start], options=search.study.options)
    assert beside is not None
    assert absorbed(beside, bias, search.surroundings) is not None  # a constant is a curve of any signal
    warm = attach(motor, "rotor", FrictionWarmup())
    later = hypothesis(search.problem, (warm, curve), search.surroundings, [start], options=search.study.options)
    assert later is not None and absorbed(later, warm, search.surroundings) is None  # of time as well
    at_position = attach(motor, "rotor", Unknown("position", 12))
    elsewhere = hypothesis(
        search.problem, (drag, at_position), search.surroundings, [start], options=search.study.options
    )
    assert elsewhere is not None and absorbed(elsewhere, drag, search.surroundings) is None


@pytest.mark.parametrize(("factor", "part"), [("", None), ("position", None), ("", (1.0, 2.0))])
def test_a_finer_curve_begins_as_the_one_it_refines(motor_data, motor, begun, factor, part) -> None:
    search = begun(motor_data(torque=lambda q, v: -0.004 * v * abs(v)), motor)
    curve = attach(motor, "rotor", Unknown("speed", 8, factor, part=part))
    heights = 0.01 * (np.arange(8) - 4.0) if part is None else 0.05 * np.sin(np.pi * np.arange(8) / 7.0)
    start = search.plain.values() | {f"{curve.prefix}.w_{k}": float(h) for k, h in enumerate(heights)}
    drawn = hypothesis(search.problem, (curve,), search.surroundings, [start], options=search.study.options)
    assert drawn is not None
    attachment, values = finer(drawn, curve, search.surroundings)
    assert sum(n.startswith(f"{curve.prefix}.w_") for n in values) == 16
    assert attachment.mechanism.part == (part and pytest.approx((part[0] - 1 / 7, part[1] + 1 / 7)))
    frozen = frozenset(n for n in values if "w_" in n)
    same = hypothesis(
        search.problem, (attachment,), search.surroundings, [values], options=search.study.options, frozen=frozen
    )
    assert same is not None and same.score < drawn.score + 0.02


@pytest.mark.parametrize(
    ("port", "signal", "tried"), [("sensor", "output", {"sensor_bias", "sensor_gain"}), ("rotor", "speed", set())]
)
def test_a_sensors_own_laws_are_tried_however_little_of_its_curve_they_match(
    motor_data, motor, begun, port, signal, tried
) -> None:
    """Seen: beside friction of a slightly wrong period an offset of the sensor matched 0.44 of its curve; from there it came to the noise,
    where the curve did not."""
    search = begun(motor_data(), motor)
    curve = attach(motor, port, Unknown(signal, 12))
    wavy = {f"{curve.prefix}.w_{k}": 0.002 * (1.0 - 2.0 * ((k // 2) % 2)) + 0.0005 for k in range(12)}
    start = search.plain.values() | wavy
    drawn = hypothesis(
        search.problem, (curve,), search.surroundings, [start], options=search.study.options, frozen=frozenset(wavy)
    )
    assert drawn is not None
    found = laws_on_curve(motor, drawn, curve, search.surroundings, {})
    assert {c.attachment.mechanism.name for c in found} == tried
    assert all(c.explained < 0.5 for c in found)
