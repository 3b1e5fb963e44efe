"""What a rival cannot imitate of another hypothesis' outputs, by other parameters and start states, however far these have to go.

Near its own estimates a rival is linear in them, and :func:`separation.evidence` says at once what it cannot imitate. Where a machine is
unstable, or two laws become the same far away, it is not: there the rival is estimated anew, as a diagnosis of the new recording will.
Source: K. Levenberg, Quarterly of Applied Mathematics 2, 1944; D. W. Marquardt, SIAM Journal 11, 1963.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.experiment_design.contender import Contender
from greybox_torch.experiment_design.separation import scaled_inverse
from greybox_torch.simulation.records import Records


@dataclass(frozen=True)
class Effort:
    """At most so many steps, while each lowers the evidence by more than a share ``enough`` of it."""

    steps: int
    enough: float


QUICK, THOROUGH = Effort(12, 0.02), Effort(60, 1e-3)
NOTHING = 0.05
"""Nats below which nothing is left to imitate."""
DAMPED, LESS, MORE, HEAVIEST = 1e-6, 0.1, 30.0, 1e6
"""Damping to begin with, its factors after a step that helps and one that does not, and where the estimation gives up."""


@dataclass(frozen=True)
class _Point:
    """A rival's values (n_p,) and start states (n_x,), with the evidence against it there, its gradient (n_d,) and curvature (n_d, n_d)."""

    values: np.ndarray
    start: np.ndarray
    nats: float
    gradient: np.ndarray
    curvature: np.ndarray


def not_imitated(
    rights: Sequence[np.ndarray], rival: Contender, records: Records, level: np.ndarray, effort: Effort = THOROUGH
) -> list[float]:
    """For each of some outputs the least over the rival's unknowns of ½ ‖(y − y_rival) / level‖² + ½ δᵀ I δ, in nats, with δ from its
    estimates. Each is on a record of its own, side by side: lanes of the same passes.

    Args:
        rights: the outputs to be imitated, y (N, n_y) each.
        records: those with the inputs that gave them.
        level: errors (n_y,), in units of which outputs differ.
    """
    records = replace(records, y=np.concatenate(rights).T.copy())
    values = np.repeat(rival.problem.values[None], len(rights), axis=0)
    normals, starts = rival.normals(records, level)
    points = [_point(rival, *own) for own in zip(normals, values, starts, strict=True)]
    damping = [DAMPED] * len(points)
    sound = [
        bool(np.isfinite(point.curvature).all()) for point in points
    ]  # where it cannot be judged, nothing is promised
    going = [k for k, fine in enumerate(sound) if fine]
    for _ in range(effort.steps):
        going = [k for k in going if points[k].nats >= NOTHING]
        if not going:
            break
        found = _moved(rival, records, going, level, [points[k] for k in going], damping)
        for k, moved in zip(list(going), found, strict=True):
            before = points[k].nats
            if moved is None or not moved.nats < before:
                damping[k] *= MORE
                if damping[k] > HEAVIEST:
                    going.remove(k)
                continue
            points[k], damping[k] = moved, damping[k] * LESS
            if before - moved.nats < effort.enough * before:
                going.remove(k)
    return [point.nats if fine else 0.0 for point, fine in zip(points, sound, strict=True)]


def _moved(
    rival: Contender,
    records: Records,
    which: Sequence[int],
    level: np.ndarray,
    at: Sequence[_Point],
    damping: Sequence[float],
) -> list[_Point | None]:
    """The points one damped step on, None where the rival cannot be simulated there.

    Args:
        records: with the outputs that are to be imitated.
        which: those that ``at`` is of; ``damping`` is by record.
    """
    proposed = [_proposed(rival, point, damping[k]) for k, point in zip(which, at, strict=True)]
    tried = [n for n, point in enumerate(proposed) if point is not None]
    found: list[_Point | None] = [None] * len(which)
    if not tried:
        return found
    values, start = (np.array([own[n] for own in proposed if own is not None]) for n in range(2))
    part = records.part([records.span(which[n]) for n in tried], [str(which[n]) for n in tried])
    normals, _ = rival.normals(part, level, start=start, values=values)
    for lane, n in enumerate(tried):
        if np.isfinite(normals[lane]).all():
            found[n] = _point(rival, normals[lane], values[lane], start[lane])
    return found


def _proposed(rival: Contender, at: _Point, damping: float) -> tuple[np.ndarray, np.ndarray] | None:
    """Values (n_p,) and start states (n_x,) one damped step on, None where they are no numbers or break a constraint."""
    problem, count = rival.problem, len(rival.free)
    moving = np.concatenate([~_held(rival, at), np.ones(len(at.gradient) - count, dtype=bool)])
    heavier = (at.curvature + damping * np.diag(np.diag(at.curvature))) * np.outer(moving, moving)
    step = -scaled_inverse(heavier) @ at.gradient
    values, start = at.values.copy(), at.start.copy()
    values[rival.free] += step[:count]
    values = np.clip(values, problem.lower, problem.upper)
    start[problem.free_states] += step[count:]
    if not (np.isfinite(values).all() and np.isfinite(start).all() and problem.admissible(values)):
        return None
    return values, start


def _held(rival: Contender, at: _Point) -> np.ndarray:
    """Which free parameters stand at a bound and would go beyond it, (n_p,)."""
    values, free = at.values[rival.free], rival.free
    down = at.gradient[: len(free)] > 0
    return np.where(down, values <= rival.problem.lower[free], values >= rival.problem.upper[free])


def _point(rival: Contender, normal: np.ndarray, values: np.ndarray, start: np.ndarray) -> _Point:
    """The point of a run whose slopes J and errors e have given [J e]ᵀ[J e], (n_d + 1, n_d + 1)."""
    away = (values - rival.problem.values)[rival.free]
    pull, count = rival.information @ away, len(rival.free)
    gradient, curvature = -normal[:-1, -1], normal[:-1, :-1].copy()
    gradient[:count] += pull
    curvature[:count, :count] += rival.information
    return _Point(values, start, 0.5 * float(normal[-1, -1] + away @ pull), gradient, curvature)
