"""The force of a spring that a model does not tell, and what a gear's error does with it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import torch

from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.mechanism import Surroundings
from greybox_torch.mechanisms.spring_force import moved_states, spring_force
from greybox_torch.mechanisms.transmission_error import TransmissionError
from greybox_torch.model import Signals
from greybox_torch.model.random_points import random_points
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records
from tests.machines.geared_drum import GearedDrum
from tests.mechanisms.attaching import attached, coupling_along_a_free_run, free_run, records_of, starts

DRUM = GearedDrum()
NONE = Signals("port", {q.name: torch.zeros((), dtype=torch.float64) for q in DRUM.all_ports})
MOVING = np.array([[0.7, 0.13, 12.0, 2.0]])


@pytest.fixture
def gear() -> tuple[Surroundings, str]:
    """The gear's surroundings and the state that its deflection can be changed by, along a recorded free run."""
    return coupling_along_a_free_run(DRUM, "gear")


def test_a_force_at_a_coupling_moves_both_masses() -> None:
    assert moved_states(DRUM, "gear", NONE) == ["w_m", "w_d"]


def test_it_is_what_the_spring_of_the_model_transmits_without_its_damper() -> None:
    *points, p = random_points(DRUM)
    x, u = DRUM.named_signals(*points)
    force = spring_force(DRUM, "gear", "-drum", ["w_m", "w_d"], x, u, p, NONE)
    twist = x.motor / p.N - x.drum
    torch.testing.assert_close(force, p.k * twist + p.k_3 * twist**3, rtol=1e-9, atol=0.0)


def test_the_coupling_knows_what_it_transmits(gear) -> None:
    around, shifted = gear
    assert shifted == "-drum"
    reach = around.ranges["deflection"].reach
    assert around.ranges["load"].reach == pytest.approx(3000.0 * reach + 1e7 * reach**3, rel=1e-6)


@pytest.mark.parametrize(("share", "conserved"), [(1.0, True), (0.0, False)])
@pytest.mark.parametrize("harmonics", [1, 3])
def test_the_whole_reaction_conserves_energy(gear, share, conserved, harmonics) -> None:
    """Virtual work: without dampers and input the energy stays, though the model does not tell what its gear carries."""
    around, shifted = gear
    error = Attachment("gear", TransmissionError(3.0, harmonics), position="motor_shaft", shifted_state=shifted)
    model = attached(DRUM, around, error)
    further = {"a_2": 0.002, "b_2": -0.001, "a_3": 0.0005} if harmonics == 3 else {}
    value = dict(model.values()) | {"c": 0.0, "b": 0.0}
    value |= {f"{error.prefix}.{n}": v for n, v in {"a": 0.004, "b": 0.003, "reaction": share, **further}.items()}
    p = np.array([value[q.name] for q in model.declared_parameters])
    records = replace(records_of(300, step=1e-4), u=np.zeros((1, 300)))
    stepper = EagerStepper.of(model, (), "cpu", "double")
    states = stepper.run(records, Pass(whole_records(records), p, starts(model, MOVING), keep_states=True)).states
    assert states is not None
    motor, drum, w_m, w_d = states[0].T
    twist = motor / 5.0 - drum
    for k in range(1, harmonics + 1):
        cosine, sine = ("a", "b") if k == 1 else (f"a_{k}", f"b_{k}")
        for name, wave in ((cosine, np.cos), (sine, np.sin)):
            twist = twist + value[f"{error.prefix}.{name}"] * wave(3.0 * k * motor)
    energy = 0.5 * 3000.0 * twist**2 + 0.25 * 1e7 * twist**4 + 0.5 * 0.001 * w_m**2 + 0.5 * 0.1 * w_d**2
    assert (np.ptp(energy) < 1e-5 * energy[0]) == conserved


def test_compiled_as_torch_has_it(gear) -> None:
    around, shifted = gear
    error = Attachment("gear", TransmissionError(3.0, 3), position="motor_shaft", shifted_state=shifted)
    model = attached(DRUM, around, error)
    value = dict(model.values()) | {f"{error.prefix}.{n}": 0.003 for n in ("a", "b_2", "a_3")}
    records, p, x0 = records_of(300), np.array(list(value.values())), starts(model, MOVING)
    np.testing.assert_allclose(
        free_run(model, records, p, x0, make_stepper(model, ())), free_run(model, records, p, x0), rtol=1e-9, atol=1e-12
    )
