"""What is drawn of laws whose first signal says little: a loop of a hysteretic spring, friction over the load."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.hysteresis import hysteresis_loop
from greybox_torch.diagnosis.describe.profiles import law_curve
from greybox_torch.diagnosis.describe.signal_names import as_named, unit_at
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.transmission import HystereticSpring
from greybox_torch.mechanisms.varying_friction import LoadDependentFriction
from greybox_torch.model.signals import parameter_signals
from greybox_torch.report.sections.law import law_chart
from tests.machines.geared_drum import GearedDrum

SPRING = Surroundings(
    {"deflection": Range(-0.2, 0.3, 0.1), "rate": Range(-1.0, 1.0, 0.5)}, {"deflection": "rad"}, "N m", 0.01
)
CARRIED = Surroundings({"speed": Range(-6.0, 6.0, 3.0), "load": Range(-1.0, 2.0, 1.0)}, {"speed": "rad/s"}, "N m", 0.01)


@pytest.mark.parametrize(("z_0", "sharpness"), [(0.01, 0.0), (0.01, 1.0), (1.0, 0.5)])
def test_a_hysteretic_spring_draws_a_loop(z_0: float, sharpness: float) -> None:
    """Seen: nothing but where the gain lies over the rate."""
    loop = hysteresis_loop(HystereticSpring(), SPRING, {"F": 2.0, "z_0": z_0, "sharpness": sharpness})
    assert loop is not None and (loop.signal, loop.unit, loop.force_unit) == ("deflection", "rad", "N m")
    half = len(loop.values) // 2
    up, down = loop.force[:half], loop.force[half:]
    assert (np.diff(loop.values[:half]) >= 0).all() and (np.diff(loop.values[half:]) <= 0).all()
    assert (loop.values.min(), loop.values.max()) == (pytest.approx(-0.2), pytest.approx(0.3))
    assert up[0] == pytest.approx(down[-1], abs=0.02) and up[-1] == pytest.approx(down[0], abs=1e-9)
    if z_0 < 0.1:
        assert up[-1] == pytest.approx(2.0, rel=1e-3) and down[-1] == pytest.approx(-2.0, rel=1e-3)
        k = int(np.argmin(np.abs(loop.values[:half] + 0.2 - z_0)))  # so far behind the reversal, exactly
        if sharpness == 0.0:
            assert up[k] == pytest.approx(2.0 * (1.0 - 2.0 * np.exp(-(loop.values[k] + 0.2) / z_0)), abs=0.3)
    without = Surroundings({"rate": Range(-1.0, 1.0, 0.5)}, {}, "N m", 0.01)
    assert hysteresis_loop(HystereticSpring(), without, {"F": 1.0, "z_0": 0.1, "sharpness": 0.5}) is None


def test_the_loop_is_named_after_the_deflection() -> None:
    model = GearedDrum()
    site = next(q for q in model.all_ports if q.name == "gear")
    loop = as_named(
        hysteresis_loop(HystereticSpring(), SPRING, {"F": 2.0, "z_0": 0.01, "sharpness": 0.0}), model, site, ("rate",)
    )
    assert loop is not None and loop.signal == "gear.deflection"
    effect = Effect("gear", "hysteretic_spring", 0.97, ("gear.rate",), "", {}, 0.9, (), loop)
    chart = law_chart(effect, loop)
    assert chart.columns[0][0].x_label == "gear.deflection [rad]"
    assert "over gear.deflection, as that goes up and down once" in chart.caption


def test_load_dependent_friction_is_drawn_over_the_load(motor) -> None:
    """Seen: drawn over the speed, and the load without a unit."""
    effect = attach(motor, "rotor", LoadDependentFriction())
    model = AugmentedModel(motor, [effect], {"rotor": CARRIED})
    values = {q.name: q.value for q in model.declared_parameters} | {f"{effect.prefix}.c": 0.1}
    curve = law_curve(model, effect, CARRIED, SimpleNamespace(parameter_tensors=parameter_signals(values)))
    assert curve is not None and (curve.signal, curve.unit) == ("load", "N m")
    assert (curve.values[0], curve.values[-1]) == (-1.0, 2.0)
    np.testing.assert_allclose(curve.force, -0.1 * np.abs(curve.values), atol=1e-3)
    assert unit_at(CARRIED, "speed") == "rad/s" and unit_at(SPRING, "load") == ""
    site = next(q for q in motor.all_ports if q.name == "rotor")
    named = as_named(curve, motor, site, ("speed",))
    assert named is not None and named.signal == "rotor.load"
