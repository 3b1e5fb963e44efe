"""Experiments that no free run follows, as nobody could know their start states well enough.

Where a machine falls into one of many wells, tumbles, or stands near an unstable equilibrium, two runs of one model that begin next to one
another part. A free run that is far from the measurement then says nothing of the model: the true one may look worse than a wrong one.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.estimate.problem import Problem
from greybox_torch.simulation.passes import Pass
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.simulation.windows import Windows


def parted(
    problem: Problem, simulator: Simulator, asked: Collection[str], settings: DiagnosisSettings
) -> dict[str, float]:
    """How far the free runs of experiments part from one that begins next to them, in units of their error, by name.

    Each state in turn begins ``settings.unseen_start`` of its travel away; the farthest of them counts, root mean square over the record.

    Zero where a free run overflows: that is the model's fault.

    Args:
        problem: with the start states of the free runs.
        asked: names of the experiments.
    """
    rows = [e for e, name in enumerate(problem.records.names) if name in asked]
    return {problem.records.names[e]: _parted(problem, simulator, e, settings.unseen_start) for e in rows}


def no_free_run_follows(experiments: Collection[str], settings: DiagnosisSettings) -> tuple[str, ...]:
    """What the reader of a verdict has to know of experiments that no free run follows, in a sentence for each."""
    return tuple(
        f"{name}: the model with effects comes out worse in a free run. That does not count, as no free run of it follows this one: "
        f"one that begins {settings.unseen_start:.0e} of a state's travel away parts from it by {100 * settings.least_parted:.0f} % of its "
        "error or more. Over windows with start states of their own the experiment did count."
        for name in sorted(experiments)
    )


@np.errstate(over="ignore", invalid="ignore")
def _parted(problem: Problem, simulator: Simulator, experiment: int, share: float) -> float:
    """How far a small change of the start state moves the outputs of one experiment, at most, in units of its error."""
    records, length = problem.records, int(problem.records.lengths[experiment])

    def runs(starts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        first, last = (np.repeat(ends[experiment], len(starts)) for ends in (records.first, records.last))
        asked = Pass(Windows(first, last, length), problem.values, starts, keep_states=True)
        run = simulator.run(problem.driving_records, asked)
        assert run.states is not None
        return run.y[:, :length], run.states[:, :length]

    start = problem.initial[experiment : experiment + 1]
    along, states = runs(start)
    if not np.isfinite(along).all():
        return 0.0
    beside, _ = runs(start + np.diag(share * np.ptp(states[0], axis=0)))
    error = along[0] - records.y[:, records.span(experiment)].T
    unit = problem.weights / max(float(np.sqrt(np.nanmean((problem.weights * error) ** 2))), 1e-300)
    moved = np.sqrt(np.mean((unit * (beside - along)) ** 2, axis=(1, 2)))
    return float(np.max(np.nan_to_num(moved, nan=np.inf), initial=0.0))
