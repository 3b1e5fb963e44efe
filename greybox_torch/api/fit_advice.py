"""What the free runs of an estimate say about the model itself."""

from __future__ import annotations

import numpy as np

from greybox_torch.api.scores import Scores
from greybox_torch.data import DataSet
from greybox_torch.data.holding_out import HELD_OUT
from greybox_torch.estimate.comparison import fits_by_output, held_out_scores, mean_fit, of_moving_outputs
from greybox_torch.estimate.problem import Problem
from greybox_torch.name_lists import listed

WORSE = 1.0
"""Points of the mean fit in % by which an estimate counts as worse than the values that it began with."""

FAR_LARGER = 2.0
"""Times the median error in the others from which an experiment's is no matter of how little moved in it."""

HARDLY = 2.0
"""Fit of an output in % up to which it is hardly simulated better than by a constant."""

DIAGNOSE = "`greybox diagnose` says what."


def fit_advice(scores: Scores, begun: str) -> str | None:
    """A sentence where the estimate simulates the validation experiments badly; else None.

    Args:
        scores: of the models "start" and "refit"; without validation experiments, those of estimation count.
        begun: which values the estimation began with, see :func:`begun_with`.
    """
    judging = {name: of_moving_outputs(held_out_scores(scores[name])) for name in ("start", "refit")}
    before, after = mean_fit(judging["start"]), mean_fit(judging["refit"])
    on = "validation" if any(s.role == "validation" for s in scores["refit"]) else "estimation"
    if not judging["refit"] or not np.isfinite(after):
        return None  # of a machine at rest, or unstable by itself, this says nothing
    if after <= 0.0:
        return (
            f"The estimate simulates the {on} experiments no better than a constant would (mean fit {after:.3g} %): a column has another "
            "sign, unit or meaning than the card says (`greybox inspect` draws them), a term of the equations has the wrong sign, the "
            f"model lacks something, or no free run follows this machine for long. {DIAGNOSE}"
        )
    if np.isfinite(before) and after < before - WORSE:
        return (
            f"The estimate simulates the {on} experiments worse than {begun} did (mean fit {after:.3g} % for {before:.3g} %). Either "
            "it has ended in another valley of the error, which more start values leave (--starts 128, in Python starts=128), or its "
            f"parameters make up for something that the model lacks: {DIAGNOSE}"
        )
    return None


def lost_outputs(scores: Scores) -> str | None:
    """A sentence where outputs are simulated hardly better than a constant would, and a far higher mean fit hides it; else None.

    Arguments as for :func:`fit_advice`.
    """
    judging = of_moving_outputs(held_out_scores(scores["refit"]))
    fits = fits_by_output(judging)
    lost = [name for name, fit in fits.items() if np.isfinite(fit) and fit <= HARDLY]
    if not lost or len(lost) == len(fits) or not mean_fit(judging) > 0.0:
        return None
    told = listed([f"{name} ({fits[name]:.3g} %)" for name in lost])
    it, its = ("it", "its") if len(lost) == 1 else ("they", "their")
    how = "no" if max(fits[name] for name in lost) <= 0.0 else "hardly"
    return (
        f"{told} {'is' if len(lost) == 1 else 'are'} simulated {how} better than a constant would, which the mean fit of "
        f"{mean_fit(judging):.3g} % hides: {its} column, sign, scale or unit on the card may be wrong, or that of what drives {it}, or the "
        f"model lacks something there. {DIAGNOSE}"
    )


def lost_in_one(scores: Scores) -> str | None:
    """A sentence where an estimation experiment has an output that is simulated no better than a constant would, with a far larger error
    than in the others, in which it is simulated better; else None: of outputs lost everywhere the other sentences speak.

    Arguments as for :func:`fit_advice`.
    """
    refit, told = of_moving_outputs(scores["refit"]), []
    for score in refit:
        others = [
            s for s in refit if s.output == score.output and s.experiment.removesuffix(HELD_OUT) != score.experiment
        ]
        better = max(others, key=lambda s: s.fit, default=None)
        if (
            score.role != "estimation"
            or better is None
            or not np.isfinite(score.fit)
            or score.fit > 0.0
            or better.fit <= 0.0
        ):
            continue
        if score.rmse >= FAR_LARGER * float(np.median([s.rmse for s in others])):
            told.append(
                f"{score.output} in {score.experiment} ({score.fit:.3g} %, in {better.experiment} {better.fit:.3g} %)"
            )
    if not told:
        return None
    return (
        f"Simulated no better than a constant would, and elsewhere better: {listed(told)}. A column of that experiment has another sign, "
        "unit or meaning than the card says (`greybox inspect` draws them), or something acted in it that the model lacks. All estimates "
        f"are bent by it. {DIAGNOSE}"
    )


def begun_with(problem: Problem, data: DataSet) -> str:
    """Which values an estimation begins with: those that the model holds, else the card's, else the declared ones."""
    free = set(problem.free_names)
    held = free & set(problem.model.held_values())
    carded = {name for name, entry in data.parameters.items() if entry.value is not None} & free - held
    sources = (
        (held, "held by the model (of a checkpoint, a result or set_values)"),
        (carded, "of the card"),
        (free - held - carded, "of the model file"),
    )
    named = [source for names, source in sources if names]
    return f"the start values {' and '.join(named)}" if named else "the start values"
