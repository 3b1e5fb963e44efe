"""Models with mechanisms attached, records for them, and their free runs."""

from __future__ import annotations

from typing import Any

import numpy as np

import greybox_torch as gt
from greybox_torch.estimate.problem import make_problem
from greybox_torch.estimate.shifted_states import shifted_state
from greybox_torch.estimate.surroundings import survey
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Mechanism, Surroundings
from greybox_torch.model import Balance, Coupling, GreyBoxModel, Input, Output, Parameter, State
from greybox_torch.simulation.eager import EagerStepper
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.records import Records
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import whole_records
from greybox_torch.systems import RobotArm

STEP = 1e-3
ARM = RobotArm()
ARM_START = np.array([[0.02, -0.01, 6.0, 5.0, 4.0]])


class Tank(GreyBoxModel):
    states = [State("level", "m", initial=1.0)]
    inputs = [Input("pump", "m/s")]
    outputs = [Output("level", "m")]
    parameters = [Parameter("k", 0.3, "1/s")]
    ports = [Balance("water", level="level")]

    def derivative(self, x: Any, u: Any, p: Any, port: Any) -> dict[str, Any]:
        return {"level": u.pump - p.k * x.level + port.water}

    def output(self, x: Any, u: Any, p: Any) -> dict[str, Any]:
        return {"level": x.level}


def records_of(samples: int, lengths: tuple[int, ...] = (), hold: str = "zoh", step: float = STEP) -> Records:
    t = step * np.arange(samples)
    u = 3.0 * np.sin(9.0 * t) + np.sin(170.0 * t + 1.0)
    sizes = np.array(lengths or (samples,))
    last = np.cumsum(sizes) - 1
    steps = np.full(samples, step)
    return Records(u[None], np.zeros((1, samples)), steps, last - sizes + 1, last, ("",) * len(sizes), hold)


def coupling_along_a_free_run(model: GreyBoxModel, name: str) -> tuple[Surroundings, str]:
    """The surroundings of a coupling and the states that its deflection can be changed by, along a recorded free run from rest."""
    records = records_of(400)
    at_rest = np.zeros((1, len(model.states)))
    run = EagerStepper.of(model, (), "cpu", "double").run(
        records, Pass(whole_records(records), values_of(model), at_rest)
    )
    outputs = (o.name for o in model.outputs)
    columns = {model.inputs[0].name: records.u[0], **dict(zip(outputs, run.y[0].T, strict=True))}
    dataset = gt.DataSet([gt.Recording.from_arrays("swing", columns, sample_time=STEP, role="estimation")])
    problem = make_problem(dataset, model, dataset.estimation())
    (coupling,) = (q for q in model.ports if isinstance(q, Coupling) and q.name == name)
    return survey(model, problem, Simulator.of(model))[name], shifted_state(model, problem, coupling)


def attached(model: GreyBoxModel, around: Surroundings, *effects: Attachment, **options: Any) -> AugmentedModel:
    return AugmentedModel(model, effects, {e.port: around for e in effects}, **options)


def values_of(model: GreyBoxModel, **given: float) -> np.ndarray:
    """The model's parameter values, some given by the end of their name."""
    values = dict(model.values())
    for end, value in given.items():
        (name,) = [n for n in values if n.endswith(f".{end}") or n == end]
        values[name] = value
    return np.array(list(values.values()))


def starts(model: GreyBoxModel, base: np.ndarray, **given: float) -> np.ndarray:
    rest = [given.get(s.name.rpartition(".")[2], 0.0) for s in model.states[base.shape[1] :]]
    return np.hstack([base, np.tile(rest, (len(base), 1))])


def free_run(model: GreyBoxModel, records: Records, p: np.ndarray, x0: np.ndarray, stepper: Any = None) -> np.ndarray:
    stepper = stepper or EagerStepper.of(model, (), "cpu", "double")
    return stepper.run(model.prepared(records, p), Pass(whole_records(records), p, x0)).y[:, :, 0]


def at(port: str, mechanism: Mechanism, **rest: Any) -> Attachment:
    return Attachment(port, mechanism, **rest)
