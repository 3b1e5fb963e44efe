"""Play between the recorded input and what acts."""

from __future__ import annotations

from types import SimpleNamespace
from typing import ClassVar

import numpy as np
import pytest

from greybox_torch.diagnosis.describe.memory import settled_curve
from greybox_torch.diagnosis.screen.candidates import memory_candidates
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.mechanisms.unknown_play import UnknownPlay
from greybox_torch.model import Balance, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records

DT, HALF = 0.1, 0.2


class Tank(GreyBoxModel):
    """What flows in fills it; nothing flows out, so that its level adds up what acts."""

    states: ClassVar = [State("level", "m")]
    inputs: ClassVar = [Input("valve", "m/s")]
    outputs: ClassVar = [Output("level", "m")]
    parameters: ClassVar = [Parameter("gain", 1.0)]
    ports: ClassVar = [Balance("tank", level="level")]

    def derivative(self, x, u, p, port):
        return {"level": p.gain * u.valve + port.tank}

    def output(self, x, u, p):
        return {"level": x.level}


AROUND = Surroundings(
    {"input": Range(-1.0, 1.0, 0.7), "time": Range(0.0, 40.0, 20.0), "level": Range(0.0, 1.0, 0.5)},
    {"input": "m/s"},
    "m/s",
    DT,
)


def with_play(half: float) -> AugmentedModel:
    tank = Tank()
    model = AugmentedModel(tank, [attach(tank, "actuator", UnknownPlay())], {q.name: AROUND for q in tank.all_ports})
    model.set_values({"actuator.unknown_play.h": half})
    return model


def levels(model: GreyBoxModel, u: np.ndarray) -> np.ndarray:
    n = len(u)
    records = Records(u[None], np.zeros((1, n)), np.full(n, DT), np.array([0]), np.array([n - 1]), ("one",), "zoh")
    values = np.array([p.value if "." not in p.name else HALF for p in model.declared_parameters])
    start = np.array([[0.0, u[0]][: len(model.states)]])
    return make_stepper(model, ()).run(records, Pass(whole_records(records), values, start)).y[0].ravel()


def played(u: np.ndarray, half: float) -> np.ndarray:
    """The play operator, sample by sample."""
    acts = [u[0]]
    for now in u[1:]:
        acts.append(min(max(acts[-1], now - half), now + half))
    return np.array(acts)


@pytest.mark.parametrize("seed", range(3))
def test_what_acts_is_what_the_play_operator_gives(seed: int) -> None:
    """Steps held for a second, of which a Tank of no other dynamics adds up what acts."""
    u = np.repeat(np.random.default_rng(seed).uniform(-1, 1, 30), 10)
    found, truth = levels(with_play(HALF), u), np.concatenate([[0.0], np.cumsum(played(u, HALF)[:-1]) * DT])
    without = np.concatenate([[0.0], np.cumsum(u[:-1]) * DT])
    # what follows half a sample late lacks half a sample of each step that gets through
    assert np.abs(found - truth).max() < 0.5 * DT * np.abs(np.diff(played(u, HALF))).max() + 1e-6
    assert np.abs(without - truth).max() > 3 * np.abs(found - truth).max()


def test_it_is_asked_for_at_actuators_among_what_remembers() -> None:
    tank = Tank()
    around = {q.name: AROUND for q in tank.all_ports}
    found = [a.port for a in memory_candidates(tank, around) if isinstance(a.mechanism, UnknownPlay)]
    assert found == ["actuator"]
    assert not [a for a in memory_candidates(tank, around, 14) if isinstance(a.mechanism, UnknownPlay)]


def test_its_curve_is_the_loop_that_it_draws() -> None:
    attachment = with_play(HALF).attachments[0]
    final = SimpleNamespace(values=lambda: {"actuator.unknown_play.h": HALF}, deviations=lambda: {}, uncertainty=None)
    curve = settled_curve(attachment, AROUND, final)
    assert curve is not None and curve.signal == "input" and curve.force_unit == "m/s"
    rising = np.diff(curve.values) > 0
    np.testing.assert_allclose(curve.force[:-1][rising], -HALF)
    np.testing.assert_allclose(curve.force[1:][~rising], HALF)


def test_play_as_wide_as_the_motion_is_refused() -> None:
    play = UnknownPlay()
    assert play.misplaced(AROUND, {"h": 0.5}) is None
    assert "a third of how far the input moved" in str(play.misplaced(AROUND, {"h": 0.8}))
