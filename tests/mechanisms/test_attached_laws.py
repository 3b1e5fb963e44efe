"""Laws attached to a model against the same written into its equations."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.transmission import Backlash
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import RobotArm
from tests.mechanisms.attaching import ARM, ARM_START, STEP, Tank, at, attached, free_run, records_of, starts, values_of


class ArmWithPlay(RobotArm):
    """The arm once more, with a dead zone written into its gear spring; where ``touching``, its damper acts outside of the gap alone."""

    touching = False

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        speed = x.motor_speed
        rub = p.F_v * speed + (p.F_c + p.F_cs / torch.cosh(p.alpha * speed)) * torch.tanh(p.beta * speed)
        beyond = torch.sign(x.gear_twist) * torch.clamp(torch.abs(x.gear_twist) - 0.005, min=0.0)
        acts = 1.0 * (beyond != 0.0) if self.touching else 1.0
        gear = p.k_g1 * beyond + p.k_g3 * beyond**3 + acts * p.d_g * (speed - x.gearbox_speed)
        arm = p.k_a * x.arm_twist + p.d_a * (x.gearbox_speed - x.arm_speed)
        return {
            "gear_twist": speed - x.gearbox_speed,
            "arm_twist": x.gearbox_speed - x.arm_speed,
            "motor_speed": (u.torque - rub - gear) / (p.J * p.a_m),
            "gearbox_speed": (gear - arm) / (p.J * p.a_g),
            "arm_speed": arm / (p.J * (1 - p.a_m - p.a_g)),
        }


def test_backlash_is_a_dead_zone_in_the_spring_and_nothing_else(around) -> None:
    model = attached(ARM, around, at("gear_spring", Backlash(), shifted_state="+gear_twist"))
    records = records_of(300)
    augmented = free_run(
        model, records, values_of(model, half_gap=0.005, k_g3=40.0), ARM_START, make_stepper(model, ())
    )
    written = ArmWithPlay()
    expected = free_run(written, records, values_of(written, k_g3=40.0), ARM_START, make_stepper(written, ()))
    without = free_run(ARM, records, values_of(ARM, k_g3=40.0), ARM_START)
    np.testing.assert_allclose(augmented, expected, rtol=0, atol=1e-12)
    assert np.abs(augmented - without).max() > 0.1


@pytest.mark.parametrize("as_force", [False, True])
def test_nothing_damps_within_a_gap(around, as_force) -> None:
    """The spring's dead zone and a damper that acts where the sides touch, by a state of the model and as a force of its own."""
    shifted = "" if as_force else "+gear_twist"
    model = attached(ARM, around, at("gear_spring", Backlash(as_force), shifted_state=shifted))
    own = ARM.values()
    lost = {"damping": own["d_g"], **({"stiffness": own["k_g1"]} if as_force else {})}
    records = records_of(300)
    augmented = free_run(model, records, values_of(model, half_gap=0.005, **lost), ARM_START, make_stepper(model, ()))
    written = ArmWithPlay()
    with_damper = free_run(written, records, values_of(written), ARM_START, make_stepper(written, ()))
    written.touching = True
    expected = free_run(written, records, values_of(written), ARM_START, make_stepper(written, ()))
    np.testing.assert_allclose(augmented, expected, rtol=0, atol=1e-9)
    assert np.abs(with_damper - expected).max() > 0.01


@pytest.mark.parametrize("hold", ["zoh", "foh"])
@pytest.mark.parametrize("samples", [0.0, 3.0, 2.4])
def test_delay_shifts_the_input(around, samples, hold) -> None:
    model = attached(Tank(), around, at("actuator", InputDelay()))
    records = records_of(90, (50, 40), hold)
    u, index = records.u[0], np.arange(50.0)
    shifted = [np.interp(index[:n] - samples, index[:n], part) for n, part in ((50, u[:50]), (40, u[50:]))]
    late = replace(records, u=np.concatenate(shifted)[None])
    x0 = np.array([[1.0], [0.4]])
    delayed = free_run(model, records, values_of(model, T=samples * STEP), x0)
    expected = free_run(Tank(), late, values_of(Tank()), x0)
    known = np.arange(50) < np.array([[50], [40]])
    np.testing.assert_allclose(delayed[known], expected[known], rtol=0, atol=1e-14)


def test_what_was_put_in_before_a_record_is_not_known(around) -> None:
    """Seen: a record under way; the torque of its first moments fell on a late actuator, whose delay was then taken for a sensor's."""
    delay = at("actuator", InputDelay())
    records = records_of(90, (50, 40))
    model = attached(Tank(), around, delay)
    missing = np.isnan(model.prepared(records, values_of(model, T=2.4 * STEP)).y[0])
    assert np.flatnonzero(missing).tolist() == [0, 1, 2, 50, 51, 52]
    looked_at = attached(Tank(), around, delay, probed=[delay])
    assert not np.isnan(looked_at.prepared(records, values_of(looked_at, T=2.4 * STEP)).y).any()


@pytest.mark.parametrize(("share", "conserved"), [(1.0, True), (0.0, False)])
def test_transmission_error_with_its_whole_reaction_neither_makes_nor_loses_energy(around, share, conserved) -> None:
    """Virtual work: an arm without friction, dampers and input keeps its energy."""
    error = Attachment("gear_spring", TransmissionError(3.0), position="motor", shifted_state="+gear_twist")
    model = attached(ARM, around, error)
    none = {"F_v": 0.0, "F_c": 0.0, "F_cs": 0.0, "d_g": 0.0, "d_a": 0.0}
    p = values_of(model, **none, a=0.02, b=0.01, reaction=share)
    records = replace(records_of(300), u=np.zeros((1, 300)))
    x0 = starts(model, np.array([[0.3, 0.0, 6.0, 5.0, 4.0]]))
    stepper = EagerStepper.of(model, (), "cpu", "double")
    states = stepper.run(records, Pass(whole_records(records), p, x0, keep_states=True)).states
    assert states is not None
    value = dict(zip((q.name for q in model.declared_parameters), p, strict=True))
    gear, arm, *speeds, angle = states[0].T
    twist = gear + 0.02 * np.cos(3.0 * angle) + 0.01 * np.sin(3.0 * angle)
    shares = (value["a_m"], value["a_g"], 1 - value["a_m"] - value["a_g"])
    energy = 0.5 * value["k_g1"] * twist**2 + 0.25 * value["k_g3"] * twist**4 + 0.5 * value["k_a"] * arm**2
    energy += sum(0.5 * value["J"] * s * w**2 for s, w in zip(shares, speeds, strict=True))
    assert (np.ptp(energy) < 1e-5 * energy[0]) == conserved
    assert (np.ptp(energy) > 1e-3 * energy[0]) != conserved
