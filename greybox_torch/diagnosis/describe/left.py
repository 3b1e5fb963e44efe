"""What the recommended model leaves of the mismatch, in the form of the verdict."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.describe.residual_tests import Detection
from greybox_torch.diagnosis.digits import digits
from greybox_torch.diagnosis.hypothesis.noise import output_floors
from greybox_torch.diagnosis.verdict import OF_ESTIMATION, Left
from greybox_torch.diagnosis.without_effects import NOISE_SHOWN
from greybox_torch.estimate.comparison import mean_fit
from greybox_torch.estimate.metrics import RUNS_AWAY, told_fit

TOLD_AS_NOISE, MOSTLY_NOISE = 0.02, 1.4
"""Share of the mismatch from which it is told that what remains is noise, and the error in units of the noise up to which most of it is."""

LEAST_OF_NOISE = 0.5
"""Times the noise below which the error of a free run shows that what was taken for noise is none."""

NEARLY_ALL = 0.9
"""Share of the mean squared error, outputs in units of their noise, from which it is told to be in one."""


def what_is_left(
    judged: Judgement,
    detected: Sequence[Detection],
    effects: bool,
    noise: float,
    *,
    shown: bool = True,
    over_windows: float = np.inf,
    fits: Sequence[float] = (0.0, 0.0),
    further: str = "",
    output: str = "",
) -> Left:
    """What remains on the validation experiments, and whether it is repeatable.

    Args:
        noise: the error, in units of the noise, up to which its kind is not told: it would read as if something were missing after all.
        shown: whether the recordings show the effects; where parameters made up for them, the re-estimated model leaves as much.
        over_windows: the error over windows of the estimation experiments, whose start states are estimated, in units of the noise.
        fits: mean fits of the re-estimated and the recommended model on the validation experiments that count, in %. Where the second is
            below zero, or the first runs away, the share that is left says nothing: it may be little of what a model leaves that is lost.
        further: a clause on what would take up much of it, where something would.
        output: in which nearly all of it is; "" where that is in none.
    """
    share, times, worst = judged.left(effects)
    parts = over_windows <= noise < times and _parts(judged, effects, worst)
    beyond = any(d.final.past.beyond for d in detected)
    coloured = any(d.final.colour.beyond for d in detected)
    linearly = (
        "past inputs do not explain it linearly"
        if all(d.final.past.judged for d in detected)
        else "whether past inputs explain it linearly cannot be judged"
    )
    how = (
        "the error is not white: steps of a sensor, the timing of samples or start states may leave as much"
        if times < noise and (beyond or coloured)
        else "windows whose start states are estimated leave hardly more than noise: nothing else is missing that they show"
        if parts
        else f"the error is {'correlated with past inputs' if beyond else 'not white'}, and part of it is repeatable: {further}"
        if further and (beyond or coloured)
        else "the error is correlated with past inputs, so that part of it is repeatable"
        if beyond
        else f"the error is not white, and {linearly}: look at it over time (greybox residuals) for what is not recorded, such as a load, "
        "or for a state that it follows"
        if coloured
        else "the error is white, as noise is"
    )
    if not np.isfinite(times):
        size = "how much of its error is noise is not known"
    elif times < LEAST_OF_NOISE:
        size = (
            f"in {worst} the free run's error is far smaller than what was taken for noise {NOISE_SHOWN}, which cannot be read from these "
            "recordings: samples too far apart for the motion look so"
        )
    else:
        as_large = "as large as" if digits(times) == "1" else f"{digits(times)} times"
        size = f"in {worst} the free run's error is {as_large} the noise {NOISE_SHOWN}"
        size += f", nearly all of it in {output}" if output and times >= noise else ""
    if parts:
        size += (
            ", as no free run follows it: a second one, whose start differs by less than the sensors show, departs from the first by "
            f"{100 * judged.settings.least_parted:.0f} % of that error or more"
        )
    whole = "The model as it stands is recommended"
    if effects:
        part = "Less than 0.01" if share < 1e-4 else digits(100 * share)
        whole = f"{part} % of the mismatch remains in free runs" if shown else "As much remains as without it"
        whole += (
            ", most of it noise" if shown and share >= TOLD_AS_NOISE and LEAST_OF_NOISE <= times < MOSTLY_NOISE else ""
        )
        without, fit = fits
        if shown and fit < 0.0:
            how_well = (
                f"have a mean fit of {told_fit(fit, 1)}, worse than a constant" if np.isfinite(fit) else "overflow"
            )
            whole = f"With what was found, free runs of the validation experiments {how_well}"
        elif shown and without < RUNS_AWAY:
            whole = (
                f"With what was found, free runs of the validation experiments have a mean fit of {told_fit(fit, 1)}; those of the model "
                "without it run away, so that what remains is no share of their error"
            )
    return Left(share, times, f"{whole}: {size}. {OF_ESTIMATION}, {how}.")


def mean_fits(judged: Judgement, but: frozenset[str]) -> tuple[float, float]:
    """Of the re-estimated model and of the one with effects on the experiments that judge, ``but`` for some, in %."""
    before, after = (mean_fit(judged.judging(run, but).scores) for run in (judged.refit, judged.with_effects))
    return before, after


def in_one_output(judged: Judgement, effects: bool) -> str:
    """The output with nearly all of what the recommended model leaves of the worst experiment; "" where none has it, or there is one."""
    _, _, worst = judged.left(effects)
    scores = (judged.with_effects if effects else judged.refit).scores
    floors = {
        r.name: row for r, row in zip(judged.recordings, output_floors(judged.problem, judged.settings), strict=True)
    }
    errors = {s.output: s.rmse for s in scores if s.experiment == worst}
    if worst not in floors or len(errors) < 2:
        return ""
    noise = dict(zip([o.name for o in judged.problem.model.outputs], floors[worst], strict=True))
    ratios = {
        name: error**2 / noise[name] for name, error in errors.items() if np.isfinite(noise[name]) and noise[name] > 0
    }
    most = max(ratios, key=lambda name: ratios[name], default="")
    return most if most and ratios[most] >= NEARLY_ALL * sum(ratios.values()) else ""


def _parts(judged: Judgement, effects: bool, experiment: str) -> bool:
    """Whether free runs of an experiment that begin next to one another part."""
    final, runs = (judged.augmented, judged.with_effects) if effects else (judged.plain, judged.refit)
    return judged.free_runs.parted(final, runs, {experiment})[experiment] >= judged.settings.least_parted
