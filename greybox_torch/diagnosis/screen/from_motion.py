"""Candidates and start values from the measured motion, beside those of the screen around simulated windows.

A screen is linear around simulated trajectories. Where the model as it stands is far from the machine these are wrong ones, and the right
law looks no better than others. The measured motion is right however wrong the model is; so the laws that explain most of what the
equations leave of it are refitted as well, from the values that they have there. Nothing is named from it: refits and held-out
experiments decide.

Source: M. Gautier, A. Janot, P.-O. Vandanjon, "A new closed-loop output error method for parameter identification of robot dynamics", IEEE
Trans. Control Systems Technology 21(2), 2013, for simulated refits that begin with inverse dynamics.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from greybox_torch.diagnosis.screen.candidates import candidates
from greybox_torch.diagnosis.screen.missing_force import missing_force
from greybox_torch.diagnosis.screen.position_spectrum import orders_over_position
from greybox_torch.diagnosis.screen.regression import Regression, regressions, with_law
from greybox_torch.diagnosis.screen.score_test import ScreenScore
from greybox_torch.diagnosis.screen.shortlist import Candidate, best_of_each, identity_of, suggested
from greybox_torch.diagnosis.screen.views import Views, views_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.estimate.equation_error import EquationError
from greybox_torch.estimate.motion_equations import MotionEquations
from greybox_torch.estimate.problem import Problem
from greybox_torch.mechanisms.attachment import Attachment, attach
from greybox_torch.mechanisms.torque_ripple import TorqueRipple
from greybox_torch.mechanisms.varying_friction import PositionDependentFriction
from greybox_torch.model import Body
from greybox_torch.simulation.side_by_side import side_by_side


def candidates_from_motion(
    study: Study,
    current: Problem,
    accepted: Sequence[Attachment] = (),
    wanted: Callable[[Attachment], bool] = lambda attachment: True,
) -> list[Candidate]:
    """The laws that explain most of what the equations leave of the measured motion, with the values they have there.

    Of either form of the equations the best few over all scales; none where the outputs do not show the motion, none where the equations
    leave so little of it that the screen around simulated windows is right, and none that does as much by chance.

    Args:
        current: the problem of the hypothesis so far, at its values, with the effects ``accepted``.
        wanted: whether an effect may join the hypothesis.
    """
    views = views_of(current, study.motion)
    if isinstance(views, str) or views.left < study.settings.least_left_of_motion:
        return []
    offered = candidates(study.problem.model, study.shifts, study.surroundings, flexible=False)
    periodic, orders = _periodic(study, views)
    tables = [
        _regressed(study, views, accepted, [a for a in some if wanted(a)], looks)
        for some, looks in ((offered, 1), (periodic, orders))
    ]
    leaders: dict[tuple, tuple[EquationError, ScreenScore]] = {}
    for form in (False, True):
        rows = [k for k, view in enumerate(views.each) if view.inverse is form]
        best = _best_over_scales([[*tables[0][k], *tables[1][k]] for k in rows], study.surroundings)
        for identity, (scale, score) in best[: study.budget.from_motion]:
            leaders.setdefault(identity, (views.each[rows[scale]], score))
    refined = side_by_side(partial(_refined, study, current, accepted, *leader) for leader in leaders.values())
    return [candidate for candidate in refined if candidate is not None]


def _regressed(
    study: Study, views: Views, accepted: Sequence[Attachment], offered: Sequence[Attachment], looks: int
) -> list[list[Regression]]:
    """By view, the regressions of effects that chance does not explain at some scale; each stands for so many ``looks``."""
    settings = study.settings
    found = regressions(views, accepted, offered, study.surroundings)
    least = settings.chance_from_motion / max(looks * sum(map(len, found)), 1)
    sure = {
        identity_of(r.score.attachment)
        for row in found
        for r in row
        if r.chance < least and r.score.explained >= settings.least_screen_share
    }
    return [[r for r in row if identity_of(r.score.attachment) in sure] for row in found]


def _best_over_scales(
    rows: Sequence[Sequence[Regression]], surroundings: Mapping
) -> list[tuple[tuple, tuple[int, ScreenScore]]]:
    """By identity, best first, at which scale an effect explains most and its score there.

    Ranked by the mean over the scales of the logarithm of what it leaves, as refits are.
    """
    left: dict[tuple, float] = {}
    where: dict[tuple, tuple[int, ScreenScore]] = {}
    for scale, row in enumerate(rows):
        for score in best_of_each([r.score for r in row], surroundings):
            identity = identity_of(score.attachment)
            left[identity] = left.get(identity, 0.0) + float(np.log(max(1.0 - score.explained, 1e-6)))
            if identity not in where or score.explained > where[identity][1].explained:
                where[identity] = (scale, score)
    return [(identity, where[identity]) for identity in sorted(left, key=lambda i: left[i])]


def _refined(
    study: Study, current: Problem, accepted: Sequence[Attachment], view: EquationError, score: ScreenScore
) -> Candidate | None:
    """An effect with all parameters that leave least in one view: those of the model, its own, and its shape."""
    values = suggested(score, study.surroundings)
    with_it = with_law(view.problem, accepted, score.attachment, study.surroundings, values)
    equations = MotionEquations(with_it, view.equations.motion, view.equations.rows)
    fitted = EquationError(equations, view.finest, view.coarser, view.inverse, view.scales).fitted()
    if fitted is None:
        return None
    found = fitted.problem.values_by_name
    own = {n: v for n, v in found.items() if n.startswith(f"{score.attachment.prefix}.")}
    before = current.values_by_name
    return Candidate(score.attachment, (found, {**before, **own}), score.explained)


def _periodic(study: Study, views: Views) -> tuple[list[Attachment], int]:
    """Periodic effects at the orders that stand out of the missing force at a body, and how many orders were looked at."""
    settings, model = study.settings, study.problem.model
    found, looked_at = [], 0
    for form in (False, True):
        view = next(iter(views.of_form(form)), None)
        for body in (p for p in model.ports if isinstance(p, Body) and view is not None):
            assert view is not None
            missing = missing_force(view, body.name)
            speed = float(np.sqrt(np.mean(missing.signals["speed"] ** 2)))
            fastest = min(2 * np.pi * views.motion.cutoff, 1.0) / float(np.median(views.motion.dt))
            for family in (TorqueRipple, PositionDependentFriction):
                orders = orders_over_position(
                    missing,
                    fastest / max(speed, 1e-12),
                    least_periods=settings.least_periods,
                    count=study.budget.order_peaks,
                    with_motion=family is PositionDependentFriction,
                )
                looked_at = max(looked_at, orders.looked_at)
                found += [attach(model, body.name, family(order)) for order in orders.best]
    return found, looked_at
