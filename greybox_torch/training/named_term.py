"""A named law in the place of a network: fitted on the same samples, judged on the same held-out stretches."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.errors import NumericalError
from greybox_torch.estimate.fit import Estimation, fit_records
from greybox_torch.estimate.notes import nearest_bound
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.estimate.simulators import fine_enough
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.simulation.simulator import Simulator
from greybox_torch.training.physics import estimate_physics
from greybox_torch.training.polish import held_out_error
from greybox_torch.training.stages import without_samples
from greybox_torch.training.trained import Trained


@dataclass(frozen=True)
class NamedTerm:
    """A law at the network's port, with the physics re-estimated beside it.

    ``match`` is the share of the learned force that the law alone draws (None for a law that is not a force); ``held_out`` the mean squared
    error of the free run on the stretches that the network was judged on, without which it was fitted; ``lost`` by which share that is
    more than the network's. ``problem`` is at the estimate without those stretches, ``simulator`` as fine as both were judged with.
    ``absent`` says that it was estimated without its effect, an amplitude of zero; "" elsewhere.
    """

    attachment: Attachment
    match: float | None
    held_out: float
    lost: float
    problem: Problem
    simulator: Simulator
    absent: str = ""

    @property
    def parameters(self) -> dict[str, float]:
        """The law's own parameters, by the names that the law has for them, in their units."""
        return self.attachment.own(self.problem.values_by_name)

    @property
    def bounds_reached(self) -> dict[str, float]:
        """Of the law's parameters that are at a bound, this bound."""
        bounds = zip(self.problem.names, self.problem.values, self.problem.lower, self.problem.upper, strict=True)
        reached = {name: nearest_bound(*placed) for name, *placed in bounds}
        return self.attachment.own({name: bound for name, bound in reached.items() if bound is not None})


def refitted_term(
    found: Trained, attachment: Attachment, starts: list[dict[str, float]], match: float | None
) -> NamedTerm | None:
    """The law of ``attachment`` instead of the network, from each of several start values; the best on the samples fitted.

    None where it cannot be simulated from any of them.
    """
    course, physics = found.course, found.physics.problem
    model = AugmentedModel(physics.model, (attachment,), found.hybrid.surroundings)
    fitted, simulator = [], None
    for start in starts:
        problem = problem_for(physics, model, start)
        if found.settings.freeze_physics:
            own = np.array([name.startswith(f"{attachment.prefix}.") for name in problem.names])
            problem = replace(problem, free=problem.free & own)
        simulator = simulator or course.simulator.for_model(model, problem.free_names)
        masked = without_samples(problem, course.mask)
        try:
            fitted.append(estimate_physics(masked, simulator, course.lengths, found.settings.seed).result)
        except NumericalError:  # this start overflows; another may not
            continue
    if not fitted or simulator is None:
        return None
    best = min(fitted, key=lambda result: result.mse).problem
    simulator = _as_fine_for_both(found, fine_enough(simulator, best))
    held_out = held_out_error(problem_for(physics, model, {}), best, simulator, course)
    lost = held_out / _networks_error(found, simulator.substeps) - 1.0
    own, around = attachment.own(best.values_by_name), found.hybrid.surroundings[attachment.port]
    absent = attachment.mechanism.absent(around, own) or ""
    return NamedTerm(attachment, match, held_out, lost, best, simulator, absent)


def _as_fine_for_both(found: Trained, simulator: Simulator) -> Simulator:
    """A law's simulator with as many sub-steps as it, the network and the training need: a steep law may need more than a network that
    was trained with few, and what too few get wrong is not the law's.
    """
    hybrid, judged = found.course.simulator, found.polished.judged
    networks = hybrid if judged is None else fine_enough(hybrid, judged)
    return simulator.with_substeps(max(simulator.substeps, hybrid.substeps, networks.substeps))


def _networks_error(found: Trained, substeps: int) -> float:
    """The network's error on the held-out stretches with so many sub-steps, or with those of its training where that is less: it has
    learned to make up for what too few get wrong.
    """
    course, judged, trained = found.course, found.polished.judged, found.polished.chosen.held_out
    if judged is None or substeps == course.simulator.substeps:
        return trained
    complete = course.unknowns.hybrid.problem
    return min(trained, held_out_error(complete, judged, course.simulator.with_substeps(substeps), course))


def on_all_samples(term: NamedTerm, found: Trained) -> Estimation:
    """The term estimated once more, on everything that the network was trained on in the end.

    Raises:
        NumericalError: the simulation overflows.
    """
    problem = replace(term.problem, records=found.physics.problem.records)
    return fit_records(problem, simulator=term.simulator, seed=found.settings.seed, starts=1)
