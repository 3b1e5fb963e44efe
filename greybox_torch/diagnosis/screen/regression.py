"""Laws regressed on what the equations leave of the measured motion: the screen's question, asked without a simulation.

A law's force, as the measured motion has it at the port, passes through the model's equations like the force of any port. Together with
the free parameters' slopes it is a regressor of the equations' errors; the share that it explains beyond the parameters ranks it.

Source: W. Khalil, E. Dombre, Modeling, Identification and Control of Robots, 2002, ch. 12.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import torch

from greybox_torch.diagnosis.screen.projection import Projection
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.views import Views
from greybox_torch.estimate.motion_equations import MotionEquations
from greybox_torch.estimate.problem import Problem, problem_for
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.augmented_model import AugmentedModel
from greybox_torch.mechanisms.mechanism import Probe, Surroundings
from greybox_torch.model import GreyBoxModel, Signals
from greybox_torch.model.ports import Actuator, Sensor

SMALL = 1e-4
"""Size of what a law is made to add to the rates while its slope is taken, in sizes of the rates themselves."""

FIRST_STEPS = (1.0, 1e-2, 1e-4, 1e-6)
"""Steps of a law's parameter, in its unit, of which the first that leads to numbers tells how large its slope is."""


@dataclass(frozen=True)
class Regression:
    """How a probe of a law does in one view: its score as a screen gives it, and how likely so much is by chance."""

    score: ScreenScore
    chance: float


def regressions(
    views: Views,
    accepted: Sequence[Attachment],
    offered: Sequence[Attachment],
    surroundings: Mapping[str, Surroundings],
) -> list[list[Regression]]:
    """By view, every probe of the attachments ``offered`` beside those ``accepted``; without those that no motion shows.

    Those are laws with a memory, delays, and what is between a true and a recorded output.
    """
    problem, base = views.equations.problem, views.equations.problem.model.plain
    projections = [Projection.of(view) for view in views.each]
    found: list[list[Regression]] = [[] for _ in views.each]
    for attachment in offered:
        if not _shown(base, attachment, surroundings):
            continue
        site = next(p for p in base.all_ports if p.name == attachment.port)
        for probe, columns in _columns(views, problem, accepted, attachment, surroundings):
            both = _averaged(views, columns)
            for k, view in enumerate(views.each):
                if view.inverse and isinstance(site, Actuator):
                    continue  # there the input is what is compared
                explained, chance, size = projections[k].tried(view.over(both[view.inverse]))
                score = ScreenScore(attachment, probe, view.finest.step, explained, size)
                found[k].append(Regression(score, chance))
    return found


def with_law(
    problem: Problem,
    accepted: Sequence[Attachment],
    attachment: Attachment,
    surroundings: Mapping[str, Surroundings],
    values: Mapping[str, float],
    *,
    probed: bool = False,
) -> Problem:
    """``problem`` with one more law beside those ``accepted``, at parameter ``values`` by name."""
    base = problem.model.plain
    model = AugmentedModel(base, [*accepted, attachment], surroundings, probed=[attachment] if probed else [])
    own = len(base.declared_parameters)
    plain = problem if problem.model is base else _without_effects(problem, base, own)
    known = problem.values_by_name
    return problem_for(plain, model, {**known, **values})


def _without_effects(problem: Problem, base: GreyBoxModel, own: int) -> Problem:
    states = len(base.states)
    names = ("values", "lower", "upper", "free", "expected")
    return replace(
        problem,
        model=base,
        names=problem.names[:own],
        initial=problem.initial[:, :states],
        initial_free=problem.initial_free[:states],
        carried=problem.carried[:states],
        **{n: getattr(problem, n)[:own] for n in names},
    )


def _shown(base: GreyBoxModel, attachment: Attachment, surroundings: Mapping[str, Surroundings]) -> bool:
    """Whether measured motion and inputs tell a law's force from one instant to the next."""
    site = next(p for p in base.all_ports if p.name == attachment.port)
    memory = attachment.mechanism.states(surroundings[attachment.port]) or "delayed" in attachment.mechanism.needs
    return not memory and not isinstance(site, Sensor)


def _columns(
    views: Views,
    problem: Problem,
    accepted: Sequence[Attachment],
    attachment: Attachment,
    surroundings: Mapping[str, Surroundings],
) -> list[tuple[Probe, np.ndarray]]:
    """For every probe of a law, what its directions add to the rates, (k, R, N)."""
    with_it = with_law(problem, accepted, attachment, surroundings, {}, probed=True)
    equations = MotionEquations(with_it, views.motion, views.equations.rows)
    moving = float(np.sqrt(np.mean(views.motion.rates[list(equations.rows)] ** 2)))
    found = []
    for probe in attachment.mechanism.probes(surroundings[attachment.port]):
        values = {**probe.values, **dict.fromkeys(probe.directions, 0.0)}
        at = {f"{attachment.prefix}.{n}": torch.tensor(float(v), dtype=torch.float64) for n, v in values.items()}
        names = [f"{attachment.prefix}.{n}" for n in probe.directions]
        found.append(
            (probe, np.array([_slope(equations, equations.parameters.replaced(**at), n, moving) for n in names]))
        )
    return found


def _slope(equations: MotionEquations, at: Signals, name: str, moving: float) -> np.ndarray:
    """What a unit of one parameter adds to the rates, (R, N), from a step that adds little to how they are ``moving``.

    A unit may lead to where the equations give no numbers, such as a dead zone of 1 m in a length of 0.9 m that divides: then from the
    largest step that does not, and none where even the smallest does.
    """
    here = equations.rates(at)
    for first in FIRST_STEPS:
        slope = _difference(equations, at, name, here, first)
        if slope is not None:
            break
    else:
        return np.zeros_like(here)
    size = float(np.sqrt(np.mean(slope**2)))
    if not 0.0 < size < np.inf:
        return slope
    refined = _difference(equations, at, name, here, SMALL * moving / size)
    return slope if refined is None else refined


def _difference(equations: MotionEquations, at: Signals, name: str, here: np.ndarray, step: float) -> np.ndarray | None:
    """What a ``step`` of one parameter adds to the rates, for a unit of it; None where that is no number."""
    added = equations.rates(at.replaced(**{name: at[name] + step})) - here
    return added / step if np.isfinite(added).all() else None


def _averaged(views: Views, columns: np.ndarray) -> dict[bool, np.ndarray]:
    """Means over the finest stretches of rates (k, R, N), and of the inputs that they amount to where the inverse form exists."""
    finest, equations = views.each[0].finest, views.equations
    found = {False: finest.mean(columns)}
    if views.of_form(True):
        found[True] = finest.mean(equations.in_inputs(columns, equations.input_slopes))
    return found
