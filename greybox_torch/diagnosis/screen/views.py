"""The measured motion seen on several scales and in both forms, each with the parameters that leave least of it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from greybox_torch.estimate.averaging import stretches
from greybox_torch.estimate.equation_error import EquationError
from greybox_torch.estimate.motion_equations import MotionEquations
from greybox_torch.estimate.problem import Problem
from greybox_torch.estimate.reconstruction import Motion, reconstructed
from greybox_torch.simulation.side_by_side import side_by_side

FACTORS = (1, 4, 16, 64)
"""Lengths of the stretches in units of the shortest, over which sensors show rates: short ones forgive nothing, long ones no trend."""

FEWEST = 32
"""Stretches of a scale, so that blocks of them tell what chance is."""

PER_PARAMETER = 4
"""Stretches for every free parameter."""


@dataclass(frozen=True)
class Views:
    """Equation errors of one model along one motion, with fitted parameters; those in the direct form first, short stretches first."""

    motion: Motion
    equations: MotionEquations
    each: tuple[EquationError, ...]

    def of_form(self, inverse: bool) -> list[EquationError]:
        """Those in the inverse form (forces from motion), or those in the direct one (rates from forces), short stretches first."""
        return [view for view in self.each if view.inverse is inverse]

    @property
    def left(self) -> float:
        """The largest error of an equation, over the shortest stretches, as a share of what it describes (root mean squares)."""
        finest, rows = self.each[0].finest, list(self.equations.rows)
        error, _ = self.each[0].equations.linearised(self.each[0].equations.start, inverse=False)
        whole, left = (np.sqrt(np.mean(finest.mean(a) ** 2, axis=1)) for a in (self.motion.rates[rows], error))
        return float(np.max(left / np.maximum(whole, 1e-300)))

    def starts(self) -> list[dict[str, float]]:
        """Parameter values by name, of either form over the longest stretches, where noise counts least."""
        last = [views[-1] for inverse in (False, True) if (views := self.of_form(inverse))]
        return [view.problem.values_by_name for view in last]


def views_of(problem: Problem, motion: Motion | str | None = None) -> Views | str:
    """The views of a problem; a clause that says why where its outputs do not show enough.

    Args:
        motion: what :func:`reconstructed` gave for the same records.
    """
    motion = reconstructed(problem) if motion is None else motion
    if isinstance(motion, str):
        return motion
    hidden = _not_shown(problem)
    if hidden:
        return f"no output shows {', '.join(hidden)}"
    equations = MotionEquations.of(problem, motion)
    if not equations.rows:
        return "no equation of a measured state has a parameter, an input or a port in it"
    finest = stretches(motion)
    least = max(FEWEST, PER_PARAMETER * int(problem.free.sum()))
    scales = [None, *(finest.coarser(factor) for factor in FACTORS[1:])]
    scales = [s for s in scales if (s or finest).count >= least]
    forms = (False, True) if equations.invertible else (False,)
    made = [EquationError.of(equations, finest, scale, inverse) for inverse in forms for scale in scales]
    sound = [view for view in made if np.isfinite(view.linearised[0]).all()]
    each = [view for view in side_by_side(view.settled for view in sound) if view is not None]
    if not each:
        return "the records are too short for what their noise leaves of the motion"
    return Views(motion, equations, tuple(each))


def _not_shown(problem: Problem) -> list[str]:
    """States and inputs of effects that are neither a position nor the time: what acted before is in them, and nothing measures it."""
    plain = problem.model.plain
    own = {s.name for s in (*plain.states, *plain.inputs)}
    added = [s.name for s in (*problem.model.states, *problem.model.inputs) if s.name not in own]
    return [n for n in added if n != "time" and not n.endswith(".position")]
