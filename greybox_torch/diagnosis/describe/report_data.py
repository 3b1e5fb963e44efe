"""What a report shows of the models: every output and input over time, and the parameters, as the card has them and estimated; and which
recordings judge them no longer.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.effect import Effect
from greybox_torch.diagnosis.hypothesis.final import Final
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.hypothesis.significance import too_few_windows
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.own_parameters import Estimate
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.traces import InputTrace, Trace
from greybox_torch.estimate.correlation import correlation_matrix
from greybox_torch.estimate.notes import at_bounds
from greybox_torch.estimate.short_validation import short_validation
from greybox_torch.estimate.slowest_time_constant import slowest_time_constant
from greybox_torch.mechanisms.actuator import InputDelay
from greybox_torch.mechanisms.sensor import OutputDelay


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


def too_short_to_judge(given: DataSet, judged: Judgement, effects: Sequence[Effect]) -> tuple[str, ...]:
    """A sentence where the validation experiments of ``given`` are short beside those of estimation, the model's time constants as it was
    re-estimated, or the times of ``effects`` (their parameters in s); none elsewhere.
    """
    values = judged.plain.values()
    problem = judged.problem.with_values(np.array([values[name] for name in judged.problem.names]))
    told = short_validation(given, slowest_time_constant(judged.problem.model.plain, problem), *times_of(effects))
    return () if told is None else (f"{told[0].upper()}{told[1:]}.",)


def too_short_to_choose(used: DataSet, plain: Hypothesis, settings: DiagnosisSettings) -> str:
    """A clause where the recordings to choose with have too few windows to tell anything from chance; "" elsewhere."""
    if not too_few_windows(plain, settings):
        return ""
    runs = used.estimation()
    samples, seconds = sum(len(r.time) for r in runs), sum(r.seconds for r in runs)
    recordings = "recording to choose with is" if len(runs) == 1 else "recordings to choose with are"
    return f"the {recordings} too short to judge ({samples} samples, {digits(seconds)} s)"


def times_of(effects: Sequence[Effect]) -> tuple[dict[str, float], dict[str, float]]:
    """The dead times of effects and their further times (of lags, memories, warming up), in s, by what a reader calls them."""
    dead: dict[str, float] = {}
    further: dict[str, float] = {}
    for effect in effects:
        of_one = dead if effect.mechanism in (InputDelay.name, OutputDelay.name) else further
        for name, entry in effect.shown_parameters.items():
            if entry.get("unit") == "s":
                of_one[f"{name} of {spoken_at(effect.mechanism, effect.port)}"] = float(entry["value"])
    return dead, further


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
    estimates, bounded = (
        [(f.values(), f.told.deviations()) for f in finals],
        [set(at_bounds(f.problem)) for f in finals],
    )

    strong = _strong_pairs(finals[-1].told)

    def of(name: str) -> Estimate:
        both = [
            (found[name], std if np.isfinite(std := deviations.get(name, np.nan)) else None)
            for found, deviations in estimates
        ]
        at_bound = name in bounded[0], effects and name in bounded[-1]
        return Estimate(
            name, units[name], values[name], both[0], both[1] if effects else None, at_bound, strong.get(name, {})
        )

    return tuple(of(name) for name in problem.free_names)


def _strong_pairs(final: Final) -> dict[str, dict[str, float]]:
    """By parameter those that its estimate moves with, and their correlation."""
    if final.uncertainty is None:
        return {}
    found: dict[str, dict[str, float]] = {}
    for one, other, correlation in correlation_matrix(final.problem.free_names, final.uncertainty).strong_pairs():
        found.setdefault(one, {})[other] = found.setdefault(other, {})[one] = correlation
    return found
