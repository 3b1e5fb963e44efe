"""An estimate as JSON."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import asdict
from typing import Any

from greybox_torch.api.estimated import estimated_parameters, estimated_starts
from greybox_torch.api.scores import Scores, scores_side_by_side
from greybox_torch.estimate.far_starts import far_starts
from greybox_torch.estimate.fit import Estimation
from greybox_torch.estimate.identifiability import Unidentifiable
from greybox_torch.estimate.profile import LEVEL, THRESHOLD, Profile
from greybox_torch.estimate.termination import Termination


def estimation_json(found: Estimation, scores: Scores, seconds: float, given: Collection[str]) -> dict[str, Any]:
    """What the estimation itself came to; ``given`` are the states that the card gives a start value."""
    problem = found.problem
    return {
        "schema": "greybox-fit/1",
        "seconds": seconds,
        "parameters": parameters_json(found),
        "initial": {name: initial_json(found, e) for e, name in enumerate(problem.records.names)},
        **({"far_starts": far} if (far := far_starts(problem, given)) else {}),
        "fit": scores_side_by_side(scores),
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
    for where, unidentifiable in (("start", before), ("optimum", after)):
        for one in unidentifiable:
            same = [row for row in result if (row["kind"], row["parameters"]) == (one.kind, list(one.parameters))]
            entry = {
                "kind": one.kind,
                "parameters": list(one.parameters),
                "direction": list(one.direction),
                "sentence": one.sentence,
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


def _correlation_json(found: Estimation) -> dict[str, Any]:
    correlation = found.correlation
    if correlation is None:
        return {"names": [], "matrix": []}
    return {"names": list(correlation.names), "matrix": correlation.matrix.tolist()}


def parameters_json(found: Estimation) -> dict[str, Any]:
    """Every parameter with its value, deviations, bounds, and whether it was estimated."""
    return {name: asdict(entry) for name, entry in estimated_parameters(found).items()}


def initial_json(found: Estimation, experiment: int) -> dict[str, Any]:
    """Every start state of one experiment."""
    return {name: asdict(entry) for name, entry in estimated_starts(found, experiment).items()}
