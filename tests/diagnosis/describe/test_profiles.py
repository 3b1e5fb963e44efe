"""The law of an effect as a curve."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import torch

from greybox_torch.diagnosis.describe.profiles import POINTS, law_curve, with_samples
from greybox_torch.diagnosis.describe.signal_names import unit_at
from greybox_torch.diagnosis.effect import Curve
from greybox_torch.diagnosis.factor import Factor
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Range, Surroundings
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.mechanisms.unknown import Unknown
from greybox_torch.model import Body, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.model.signals import parameter_signals

AROUND = Surroundings({"speed": Range(-6.0, 6.0, 3.0)}, {}, "N m", 0.01)


def drawn(motor, law: Unknown, highest: int, around: Surroundings = AROUND) -> Curve:
    """A curve whose bump of that number alone is one high."""
    effect = attach(motor, "rotor", law)
    model = AugmentedModel(motor, [effect], {"rotor": around})
    values = {q.name: q.value for q in model.declared_parameters} | {f"{effect.prefix}.w_{highest}": 1.0}
    problem: Any = SimpleNamespace(parameter_tensors=parameter_signals(values))
    curve = law_curve(model, effect, around, problem)
    assert curve is not None
    return curve


@pytest.mark.parametrize("highest", range(1, 19, 4))
def test_a_curve_over_a_part_is_drawn_with_its_peaks(motor, highest: int) -> None:
    """Seen by reading: a twelfth of the range, and hardly one point for each of its twenty bumps."""
    curve = drawn(motor, Unknown("speed", 20, part=(2.03, 3.03)), highest)
    assert curve.force.max() == pytest.approx(1.0, abs=0.01)
    assert len(curve.values) == 2 * POINTS and (np.diff(curve.values) >= 0).all()


def test_a_curve_over_the_range_is_drawn_evenly_and_none_beyond_the_range(motor) -> None:
    even = torch.linspace(-6.0, 6.0, POINTS, dtype=torch.float64).numpy()
    np.testing.assert_array_equal(drawn(motor, Unknown("speed"), 3).values, even)
    beyond = drawn(motor, Unknown("speed", 8, part=(5.5, 6.5)), 3).values
    assert (beyond.min(), beyond.max()) == (-6.0, 6.0) and set(even) <= set(beyond)


def test_a_delayed_input_has_the_unit_of_the_input() -> None:
    assert unit_at(Surroundings({}, {"input": "N"}, "N", 0.01), "delayed") == "N"


def test_what_multiplies_a_curve_is_given_with_it(motor) -> None:
    """The force is the one at the factor's root mean square: a height of one, times that."""
    both = Surroundings({**AROUND.ranges, "position": Range(-1.0, 4.0, 2.5)}, {"position": "rad"}, "N m", 0.01)
    curve = drawn(motor, Unknown("speed", factor="position"), 5, both)
    assert curve.factor == Factor("position", "rad", 2.5)
    assert curve.force.max() == pytest.approx(2.5, rel=0.02) and curve.force_unit == "N m"
    assert drawn(motor, Unknown("speed"), 5, both).factor is None
    never_positive = Surroundings(
        {**AROUND.ranges, "position": Range(-4.0, -1.0, 2.5)}, {"position": "rad"}, "N m", 0.01
    )
    curve = drawn(motor, Unknown("speed", factor="position"), 5, never_positive)
    assert curve.factor == Factor("position", "rad", -2.5) and curve.force.min() == pytest.approx(-2.5, rel=0.02)


@pytest.mark.parametrize(("order", "turns"), [(2.0, 1.0), (2.002, 2 / 2.002), (0.25, 4.0)])
def test_a_law_that_repeats_is_drawn_over_a_turn(motor, order: float, turns: float) -> None:
    """Seen: a transmission error over the deflection, which it does not depend on, as a level line; a ripple over 150 rad in 201 points."""
    around = Surroundings({**AROUND.ranges, "position": Range(-90.0, 60.0, 40.0)}, {"position": "rad"}, "N m", 0.01)
    effect = attach(motor, "rotor", TorqueRipple(order))
    model = AugmentedModel(motor, [effect], {"rotor": around})
    values = {q.name: q.value for q in model.declared_parameters} | {f"{effect.prefix}.a": 0.3}
    problem: Any = SimpleNamespace(parameter_tensors=parameter_signals(values), values_by_name=values)
    curve = law_curve(model, effect, around, problem)
    assert curve is not None and curve.signal == "position"
    assert (curve.values[0], curve.values[-1]) == (0.0, pytest.approx(2 * np.pi * turns))
    assert np.ptp(curve.force) == pytest.approx(0.6, rel=0.01)
    over = with_samples(curve, {"position": np.linspace(-90.0, 60.0, 4000)}, repeats=True)
    assert over is not None and over.seen is not None and over.seen.sum() == 4000


class Screw(GreyBoxModel):
    """A motor, or a slide, that drives a load by a spring; nobody says what unit the position has at the coupling."""

    inputs = [Input("force", "N")]
    outputs = [Output("place")]
    parameters = [Parameter("k", 5.0)]
    ports = [
        Body("drive", speed="speed", position="place"),
        Coupling("spring", deflection="twist", rate=lambda x, u, p: x.speed),
    ]

    def __init__(self, unit: str) -> None:
        self.states = [State("place", unit), State("speed", f"{unit}/s"), State("twist", unit)]
        super().__init__()

    def derivative(self, x, u, p, port):
        return {"place": x.speed, "speed": u.force - port.spring, "twist": x.speed - p.k * x.twist}

    def output(self, x, u, p):
        return {"place": x.place}


@pytest.mark.parametrize(("unit", "periods"), [("m", 1), ("rad", 3)])
def test_a_transmission_error_is_drawn_over_the_position_of_what_drives(unit: str, periods: int) -> None:
    """Seen: the error of a screw over 3 m, as if those were a turn."""
    model = Screw(unit)
    ranges = {name: Range(-9.0, 9.0, 3.0) for name in ("deflection", "position", "rate")}
    around = Surroundings(ranges, {"deflection": unit}, "N", 0.01)
    effect = attach(model, "spring", TransmissionError(3.0), "+twist")
    made = AugmentedModel(model, [effect], {"spring": around})
    values = {q.name: q.value for q in made.declared_parameters} | {f"{effect.prefix}.a": 0.3}
    problem: Any = SimpleNamespace(parameter_tensors=parameter_signals(values), values_by_name=values)
    curve = law_curve(made, effect, around, problem)
    assert curve is not None and (curve.signal, curve.unit) == ("position", unit)
    assert curve.values[-1] == pytest.approx(periods * 2 * np.pi / 3.0)
    assert (curve.force.min(), curve.force.max()) == (pytest.approx(-0.3, rel=0.01), pytest.approx(0.3, rel=0.01))
