"""Which parameters the data cannot determine, alone or together, before they are estimated and after.

At a point z the outputs change by J dz, so that what leaves JᵀJ dz = 0 cannot be seen. Directions in which that is so are looked for in
unknowns scaled to unit diagonal, and named parameter by parameter after a reduction to echelon form, which keeps apart what has nothing to
do with each other. Since a matrix at one point may be singular for no reason but the point (a shape has no effect while its amplitude is
zero), every such finding is looked at again at a point nearby: a direction that data can never show is flat almost everywhere.

Source: T. J. Rothenberg, "Identification in parametric models", Econometrica 39 (1971): rank of the information matrix at a regular point.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from greybox_torch.estimate.free_run import FreeRun
from greybox_torch.estimate.identifiability_sentences import Direction, sentence
from greybox_torch.estimate.information import Information, echelon
from greybox_torch.estimate.levenberg_marquardt import Quadratic
from greybox_torch.linear_algebra import eigh, pseudo_inverse

PROMINENT = 0.3
"""Part of a weak direction's largest relative change from which a parameter is named."""

NEARBY = 0.1
"""How far off, relative to their size, the unknowns are at the point nearby."""


@dataclass(frozen=True)
class Unidentifiable:
    """What the data do not determine.

    ``kind`` is "unmoved" (nothing the parameter does shows in the outputs), "together" (only a combination shows), "start" (either of
    these, but only because of where the unknowns are), "weak" (the standard deviation exceeds the value) or "numbers" (nothing can be
    told, as the derivatives have grown without bound). ``parameters`` are those
    involved, start states among them as "motor_speed at the start of 'Steps'"; ``direction`` their changes that leave the outputs as they
    are: relative to their value where that is not zero, else in their unit, the largest being 1.
    """

    kind: str
    parameters: tuple[str, ...]
    direction: tuple[float, ...]
    sentence: str

    @property
    def undetermined(self) -> bool:
        """Whether no estimate of these parameters means anything, as against one that is merely uncertain."""
        return self.kind in ("unmoved", "together")


def identifiability(run: FreeRun, z: np.ndarray, here: Quadratic[None] | None = None) -> tuple[Unidentifiable, ...]:
    """What the data do not determine of the unknowns ``z`` (d,) of ``run``; nothing where the simulation overflows there.

    Args:
        here: cost and Gauss-Newton Hessian at ``z``, computed where it is not given.
    """
    here = here or run.quadratic(z)
    if here is None or not run.n_parameters:
        return ()
    view = Information(run, z, here.hessian)
    unmoved, flat = view.unmoved(), view.flat_directions()
    if len(flat) and view.exploded():
        return (_failed(view),)
    if len(flat):
        closer = view.closer()
        seen = closer.flat_directions()
        if len(seen) < len(flat):
            view, flat = closer, seen
    nearby = _nearby(view, here) if len(unmoved) or len(flat) else None
    found = [_unmoved(view, i, nearby, here) for i in unmoved if i < run.n_parameters]
    found += [_together(view, step, nearby, here) for step in flat]
    held = {*unmoved, *[int(np.argmax(np.abs(step) * np.sqrt(np.diag(view.hessian)))) for step in flat]}
    return (*found, *_weak(view, here, held))


def _nearby(view: Information, here: Quadratic[None], only: int | None = None) -> Information | None:
    """The view from a point at which no unknown is zero, at a bound, or equal to another by chance; None where nothing simulates there.

    Args:
        only: the one unknown that is moved, instead of all.
    """
    run, z = view.run, view.z
    diagonal, (low, high) = np.diag(here.hessian), run.bounds
    typical = np.sqrt(
        2 * here.cost / np.where(diagonal > 0, diagonal, np.inf)
    )  # moves the outputs as much as they are off
    finite = np.isfinite(high - low)
    typical = np.where(typical > 0, typical, np.where(finite, np.where(finite, high - low, 0.0), 1.0))
    away = NEARBY * np.random.default_rng(0).uniform(0.5, 1.0, len(z)) * np.where(z != 0, np.abs(z), typical)
    away = np.where(z + away > high, -away, away)
    if only is not None:
        away = np.where(np.arange(len(z)) == only, away, 0.0)
    for _ in range(6):
        point = np.clip(z + away, low, high)
        there = run.quadratic(point) if run.admissible(point) else None
        if there is not None:
            return replace(view, z=point, hessian=there.hessian, by_samples=False)
        away = 0.5 * away
    return None


def _failed(view: Information) -> Unidentifiable:
    """Derivatives that have grown without bound are alike but for rounding, as if nothing could be told apart."""
    names = view.run.problem.free_names
    told = (
        f"No standard deviation is known, and not what the data determine: the derivatives have grown to {view.exploded():.0e} "
        "times the outputs, so it is the numbers that failed there, and not the data. Something in the model is too fast for the steps of "
        "its integration, as dry friction is whose speed v_0 is very small: hold what makes it so at a slower value (fixed), or raise its "
        "lower bound"
    )
    return Unidentifiable("numbers", tuple(names), (), told)


def _unmoved(view: Information, index: int, nearby: Information | None, here: Quadratic[None]) -> Unidentifiable:
    name = _names(view.run)[index]
    step = Direction((name,), (1.0,), (view.z[index] != 0,))
    if nearby is None or index in nearby.unmoved():
        return Unidentifiable("unmoved", (name,), step.changes, sentence("unmoved", step))
    zeros = _culprits(view, here, lambda there: index not in there.unmoved())
    return Unidentifiable("start", (name,), step.changes, sentence("start", step, zeros=zeros))


def _together(view: Information, step: np.ndarray, nearby: Information | None, here: Quadratic[None]) -> Unidentifiable:
    members = np.flatnonzero(step)
    nonzero = (view.z[members] != 0) & (members < view.run.n_parameters)
    changes = step[members] / np.where(nonzero, view.z[members], 1.0)
    changes, absolute = changes / _largest(changes), step[members] / _largest(step[members])
    names = tuple(_names(view.run)[i] for i in members)
    direction = Direction(names, tuple(changes.tolist()), tuple(nonzero.tolist()), absolute=tuple(absolute.tolist()))
    if nearby is not None and not nearby.is_flat_within(members):
        zeros = _culprits(view, here, lambda there: not there.is_flat_within(members))
        return Unidentifiable("start", names, direction.changes, sentence("start", direction, zeros=zeros))
    if nearby is not None:
        scaled = np.zeros(len(step))
        scaled[members] = changes * nearby.z[members]
        law = "factor" if nonzero.all() and nearby.is_flat(scaled) else "shift" if nearby.is_flat(step) else "local"
        direction = replace(direction, law=law)
    return Unidentifiable("together", names, direction.changes, sentence("together", direction))


def _culprits(view: Information, here: Quadratic[None], helps: Callable[[Information], bool]) -> tuple[str, ...]:
    """The parameters that are zero and that, moved from there alone, give others their effect."""
    zeros = np.flatnonzero(view.z[: view.run.n_parameters] == 0)
    views = {int(k): _nearby(view, here, int(k)) for k in zeros}
    names = view.run.problem.free_names
    return tuple(names[k] for k, there in views.items() if there is not None and helps(there))


def _weak(view: Information, here: Quadratic[None], held: set[int]) -> list[Unidentifiable]:
    """Directions in which the parameters' relative standard deviation exceeds one, the ``held`` unknowns fixed.

    The errors' variance is what a linear model leaves after the best step from here, so that poor start values are not taken for noise.
    """
    kept = np.setdiff1d(np.arange(len(view.z)), sorted(held))
    scale = view.scale[kept]
    inverse = pseudo_inverse(
        view.hessian[np.ix_(kept, kept)] * np.outer(scale, scale), rcond=view.rounding, hermitian=True
    )
    inverse *= np.outer(scale, scale)
    gradient = here.gradient[kept]
    left = 2 * here.cost - float(gradient @ inverse @ gradient)
    variance = max(left, 0.0) / max(view.run.problem.samples - len(kept), 1)
    own = np.flatnonzero((kept < view.run.n_parameters) & (view.z[kept] != 0))
    value = view.z[kept[own]]
    spread = variance * inverse[np.ix_(own, own)] / np.outer(value, value)
    values, vectors = eigh(spread)
    names, found = _names(view.run), []
    for row in echelon(vectors[:, values > 1.0].T, PROMINENT):
        members = np.flatnonzero(row)
        involved = tuple(names[kept[own[i]]] for i in members)
        step = Direction(involved, tuple((row[members] / np.abs(row).max()).tolist()), (True,) * len(members))
        deviation = float(np.sqrt(spread[members[0], members[0]]))
        found.append(Unidentifiable("weak", involved, step.changes, sentence("weak", step, deviation=deviation)))
    return found


def _largest(changes: np.ndarray) -> float:
    """The change of largest size, the first of those that are so but for rounding."""
    sizes = np.abs(changes)
    return float(changes[np.argmax(sizes > 0.999 * sizes.max())])


def _names(run: FreeRun) -> list[str]:
    problem = run.problem
    states = [problem.model.states[i].name for i in problem.free_states]
    return [*problem.free_names, *[f"{s} at the start of '{e}'" for e in problem.records.names for s in states]]
