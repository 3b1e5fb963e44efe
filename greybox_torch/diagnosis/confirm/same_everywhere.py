"""Whether what acts slowly is a constant of the machine, or a drift that happens to have one sign in every experiment.

A slow disturbance (temperature, an amplifier that wanders) is another one in each experiment. Of a few experiments all may be pushed the
same way by chance; a constant pushes all of them equally.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np

from greybox_torch.diagnosis.hypothesis.fit import Hypothesis, window_lengths
from greybox_torch.diagnosis.settings import SearchBudget
from greybox_torch.estimate.initial import beginning
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.estimate.window_fit import fit_windows
from greybox_torch.estimate.window_information import window_information
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.forces import ConstantBias
from greybox_torch.mechanisms.mechanism import SHARE, Mechanism, Surroundings
from greybox_torch.simulation.side_by_side import side_by_side
from greybox_torch.simulation.simulator import Simulator

CHANCE = 0.01
"""Probability that a drift without any constant is taken for one."""

CHANCE_FAR_ABOVE = 0.05
"""The same of what windows show as well and leaves far more in free runs than disturbances do: constants of machines scatter, too. Of 42
offsets of five blind proofs and of machines from elsewhere one is above 0.008, at 0.024, and that far above; a complete arm that drifts was
at 0.024, 5 times the noise.
"""

FEWEST = 3
"""Experiments from which that is asked: of two, each has to be within a tenth of their mean."""


def same_everywhere(
    found: Hypothesis,
    problem: Problem,
    around: Surroundings,
    effect: Attachment,
    budget: SearchBudget,
    begun: np.ndarray,
    chance: float = CHANCE,
) -> bool:
    """Whether an effect of one amplitude has it in every experiment, by Student's t of the amplitudes fitted to each alone.

    What they scatter more than each is uncertain by is counted as drift. Of effects with several amplitudes, and of one experiment, nothing
    is said.

    Args:
        problem: the plain model on all experiments.
        around: of the effect's port.
        begun: where the experiments begin (E, n_x), as free runs of ``found`` have it. A position that no sensor shows is where an effect
            that follows it is. Seen: a sensor's offset beside friction that varies with position, looked for with that at another phase:
            another offset in every experiment, and it was taken back though nothing but noise was left with it.
        chance: that a drift without any constant is taken for one.
    """
    directions = {name for probe in effect.mechanism.probes(around) for name in probe.directions}
    if len(directions) != 1 or SHARE in directions or len(problem.records.first) < 2:
        return True
    name = f"{effect.prefix}.{next(iter(directions))}"
    restated = replace(problem_for(problem, found.model, found.values()), initial=begun)
    simulator = found.simulator.for_model(found.model, (name,))
    experiments = range(len(problem.records.first))
    alone = side_by_side(partial(_alone, restated, simulator, name, e, budget) for e in experiments)
    sizes, variances = np.array([pair for pair in alone if pair is not None]).reshape(-1, 2).T
    return constant(sizes, variances, chance)


def drifts(
    found: Hypothesis,
    problem: Problem,
    around: Surroundings,
    effect: Attachment,
    budget: SearchBudget,
    begun: np.ndarray,
    chance: float = CHANCE,
) -> bool:
    """Whether an offset that windows show is another one in each of several experiments, and so a drift; arguments as above."""
    asked = is_offset(effect.mechanism) and len(problem.records.first) >= FEWEST
    return asked and not same_everywhere(found, problem, around, effect, budget, begun, chance)


def is_offset(mechanism: Mechanism) -> bool:
    """Whether a law is a constant one: of a force, an input or an output."""
    return mechanism.nature == ConstantBias.nature


def constant(sizes: np.ndarray, variances: np.ndarray, chance: float = CHANCE) -> bool:
    """Whether ``sizes`` (n,), each known with a variance (n,), have a mean that their further scatter does not make by chance.

    Source: W. S. Gosset ("Student"), The Probable Error of a Mean, Biometrika 6, 1908.
    """
    from scipy.special import stdtrit  # not every diagnosis needs it

    count = len(sizes)
    if count < 2:
        return True
    between = max(float(np.var(sizes, ddof=1)) - float(np.mean(variances)), 0.0)
    least = stdtrit(count - 1, 1.0 - chance / 2) * np.sqrt(between / count)
    return abs(float(np.mean(sizes))) >= float(least)


def _alone(
    restated: Problem, simulator: Simulator, name: str, experiment: int, budget: SearchBudget
) -> tuple[float, float] | None:
    """The amplitude ``name`` fitted to one experiment over its longest windows, all else as it is, and its variance."""
    free = np.array([n == name for n in restated.names])
    part, shorter = replace(beginning(restated, experiment, 1.0), free=free), None
    for length in window_lengths(part, budget):
        fit = fit_windows(part, simulator, length, shorter=shorter, settings=budget.window_iterations)
        if fit is None:
            return None
        part, shorter = fit.problem, fit
    information = None if shorter is None else window_information(shorter, simulator)
    if shorter is None or information is None or not information[0, 0] > 0.0:
        return None
    return float(shorter.problem.values[free][0]), shorter.mean_square / float(information[0, 0])
