"""What `greybox fit` writes to fit.json and prints with --json."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from greybox_torch.commands.free_runs import scores_json
from greybox_torch.estimate.comparison import Score
from greybox_torch.estimate.fit import FitResult
from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.profile import LEVEL, THRESHOLD, Profile
from greybox_torch.estimate.termination import Termination

Scores = dict[str, tuple[Score, ...]]
"""Rows by model ("start", "refit", and "augmented" where there is one), in the order of the data set's experiments."""


def result_json(found: FitResult, scores: Scores, seconds: float) -> dict[str, Any]:
    """The result as `fit --json` prints it."""
    problem = found.problem
    return {
        "schema": "greybox-fit/1",
        "seconds": seconds,
        "parameters": parameters_json(found),
        "initial": {name: initial_json(found, e) for e, name in enumerate(problem.records.names)},
        "fit": [
            {
                **{k: v for k, v in start.items() if k not in ("fit", "rmse")},
                "start": _numbers(start),
                "refit": _numbers(refit),
            }
            for start, refit in zip(scores_json(scores["start"]), scores_json(scores["refit"]), strict=True)
        ],
        "statistics": {
            "mse": found.mse,
            "fpe": found.fpe,
            "samples": found.samples,
            "iterations": found.iterations,
            "evaluations": found.evaluations,
            "status": status(found.termination),
            "termination": found.termination.value,
            "notes": [{"kind": note.kind.name, "sentence": note.sentence} for note in found.notes],
        },
        "substeps": found.substeps,
        "correlation": _correlation_json(found),
    }


def status(termination: Termination) -> str:
    """One word on how it ended: "converged", or what kept it from that."""
    both = (Termination.converged, Termination.small_step)
    return "converged" if termination in both else termination.name


def identifiability_json(before: Sequence[Unidentifiable], after: Sequence[Unidentifiable]) -> list[dict[str, Any]]:
    """What the data do not determine, and whether it was seen at the start values, at the optimum, or at both."""
    result = []
    for where, weaknesses in (("start", before), ("optimum", after)):
        for weakness in weaknesses:
            same = [
                row for row in result if (row["kind"], row["parameters"]) == (weakness.kind, list(weakness.parameters))
            ]
            entry = {
                "kind": weakness.kind,
                "parameters": list(weakness.parameters),
                "direction": list(weakness.direction),
                "sentence": weakness.sentence,
                "at": [*(same[0]["at"] if same else []), where],
            }
            result = [row for row in result if row not in same] + [entry]
    return result


def profile_json(found: Profile) -> dict[str, Any]:
    """A profile likelihood: its 95 % interval, null where that is open, and the points it was drawn through."""
    return {
        "unit": found.unit,
        "estimate": found.estimate,
        "lower": found.lower,
        "upper": found.upper,
        "level": LEVEL,
        "threshold": THRESHOLD,
        "colour": found.colour,
        "at_bound": {"lower": found.lower_bound, "upper": found.upper_bound},
        "values": found.values.tolist(),
        "rise": found.rise.tolist(),
        "sentence": found.sentence,
    }


def _correlation_json(found: FitResult) -> dict[str, Any]:
    correlation = found.correlation
    if correlation is None:
        return {"names": [], "matrix": []}
    return {"names": list(correlation.names), "matrix": correlation.matrix.tolist()}


def parameters_json(found: FitResult) -> dict[str, Any]:
    """Every parameter with its value, deviations, bounds, and whether it was estimated."""
    problem = found.problem
    plain, sandwich = found.parameter_deviations(), found.parameter_deviations("sandwich")
    result = {}
    for k, declared in enumerate(problem.model.declared_parameters):
        result[declared.name] = {
            "value": float(problem.values[k]),
            "std": plain.get(declared.name, 0.0),
            "std_sandwich": sandwich.get(declared.name, 0.0),
            "unit": declared.unit,
            "fixed": not bool(problem.free[k]),
            "lower": float(problem.lower[k]),
            "upper": float(problem.upper[k]),
            "description": declared.description,
        }
    return result


def initial_json(found: FitResult, experiment: int) -> dict[str, Any]:
    """Every start state of one experiment."""
    problem = found.problem
    plain, sandwich = found.initial_deviations(), found.initial_deviations("sandwich")
    return {
        state.name: {
            "value": float(problem.initial[experiment, i]),
            "std": float(plain[experiment, i]),
            "std_sandwich": float(sandwich[experiment, i]),
            "unit": state.unit,
            "fixed": not bool(problem.initial_free[i]),
        }
        for i, state in enumerate(problem.model.states)
    }


def _numbers(row: dict[str, Any]) -> dict[str, float]:
    return {"fit": row["fit"], "rmse": row["rmse"]}
