"""What a report shows of the models: every output and input over time, and the parameters, as the card has them and estimated; and which
recordings judge them no longer.
"""

from __future__ import annotations

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.verdict import Estimate, InputTrace, Trace


def traces(judged: Judgement, effects: bool) -> tuple[Trace, ...]:
    """Every output of every experiment over time, measured and simulated by each of the models."""
    records, last = judged.problem.records, judged.with_effects if effects else judged.refit
    result = []
    for e, recording in enumerate(judged.recordings):
        for k, output in enumerate(judged.problem.model.outputs):
            simulated = [c.simulated[e][:, k] for c in (judged.start, judged.refit, last)]
            measured, time_axis = records.y[k, records.span(e)], records.time(e)
            result.append(
                Trace(recording.name, recording.role, output.name, output.unit, time_axis, measured, *simulated)
            )
    return tuple(result)


def no_longer_validation(given: DataSet, used: DataSet) -> tuple[str, ...]:
    """A sentence for each validation experiment of ``given`` that is chosen with in ``used``, or the beginning of which is."""
    held_out = {r.name for r in given.validation()}
    parts = [r for r in used.validation() if r.name not in held_out]
    rests = {name: r.name for r in parts for name in held_out if r.name.startswith(f"{name} from ")}
    why = "was taken to choose with as well (the evidence says why)"
    return tuple(
        f"Of {r.name} only {rests[r.name]} counts as validation: its beginning {why}."
        if r.name in rests
        else f"{r.name} no longer counts as validation: it {why}."
        for r in used.estimation()
        if r.name in held_out
    )


def inputs(judged: Judgement) -> tuple[InputTrace, ...]:
    """The recorded inputs of all experiments."""
    records, found = judged.problem.records, []
    for e, recording in enumerate(judged.recordings):
        for k, one in enumerate(judged.problem.model.inputs):
            values = records.u[k, records.span(e)]
            found.append(InputTrace(recording.name, one.name, one.unit, records.time(e), values, records.hold == "zoh"))
    return tuple(found)


def parameters(judged: Judgement, effects: bool) -> tuple[Estimate, ...]:
    """The free parameters of the model itself: as the card has them, re-estimated, and with the effects."""
    problem, finals = judged.problem, (judged.plain, *((judged.augmented,) if effects else ()))
    units = {p.name: p.unit for p in problem.model.declared_parameters}
    values = dict(zip(problem.names, map(float, problem.values), strict=True))
    estimates = [(f.values(), f.deviations()) for f in finals]

    def of(name: str) -> Estimate:
        both = [
            (found[name], std if np.isfinite(std := deviations.get(name, np.nan)) else None)
            for found, deviations in estimates
        ]
        return Estimate(name, units[name], values[name], both[0], both[1] if effects else None)

    return tuple(of(name) for name in problem.free_names)
