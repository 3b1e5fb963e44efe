"""A tank that only adds up what flows in: what acts at its valve can be read from its level."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any, ClassVar

import numpy as np

from greybox_torch.diagnosis.screen.candidates import memory_candidates
from greybox_torch.mechanisms.attachment import attach
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Mechanism
from greybox_torch.mechanisms.surroundings import Range, Surroundings
from greybox_torch.model import Balance, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import make_stepper
from greybox_torch.simulation.windows import whole_records

DT = 0.1


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


def tank_with(mechanism: Mechanism, **values: float) -> AugmentedModel:
    """The tank with ``mechanism`` at its valve, its parameters as given."""
    tank = Tank()
    model = AugmentedModel(tank, [attach(tank, "actuator", mechanism)], {q.name: AROUND for q in tank.all_ports})
    model.set_values({f"actuator.{mechanism.name}.{name}": value for name, value in values.items()})
    return model


def levels(model: GreyBoxModel, u: np.ndarray, added: float | None = None) -> np.ndarray:
    """The tank's level (N,) for what the valve is told (N,); a state that the mechanism adds begins at ``added``, else at the input."""
    n = len(u)
    records = Records(u[None], np.zeros((1, n)), np.full(n, DT), np.array([0]), np.array([n - 1]), ("one",), "zoh")
    now = model.values()
    values = np.array([now[p.name] for p in model.declared_parameters])
    start = np.array([[0.0, u[0] if added is None else added][: len(model.states)]])
    return make_stepper(model, ()).run(records, Pass(whole_records(records), values, start)).y[0].ravel()


def ports_asked(law: type[Mechanism], knots: int = 0) -> list[str]:
    """The ports of the tank at which a form of what remembers is asked."""
    tank = Tank()
    offered = memory_candidates(tank, {q.name: AROUND for q in tank.all_ports}, knots)
    return [a.port for a in offered if isinstance(a.mechanism, law)]


def fitted(law: str, values: Mapping[str, float]) -> Any:
    """What a final fit says of a form at the actuator, as far as its curve asks."""
    own = {f"actuator.{law}.{name}": value for name, value in values.items()}
    told = SimpleNamespace(values=lambda: own, deviations=lambda: {}, uncertainty=None)
    return SimpleNamespace(**vars(told), told=told)
