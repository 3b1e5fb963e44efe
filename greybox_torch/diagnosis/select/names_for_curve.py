"""Named effects in the place of a free curve: whether they come as far, may yet do, or are pieces of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from functools import partial

from greybox_torch.diagnosis.hypothesis.significance import window_significance
from greybox_torch.diagnosis.select.choice import alone_at_noise
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.model.joined_bodies import joined_bodies


def as_far_as_curve(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether the effects of ``branch`` come as far as the curve of ``with_curve``, from the hypothesis that both build on.

    More than ``most_names_for_curve`` of them have to come farther: what one curve at one place explains is simpler than as many laws at
    several. Seen: the heat that shear makes in an extruder, a curve beside which a sensor's gain, a constant, an input's offset and a lag
    were told, each by its name and each wrong.
    """
    if in_pieces(study, with_curve, branch):
        return False
    settings, (reached, ceiling) = study.settings, gains(with_curve, branch)
    if many_names(study, with_curve, branch):
        return reached >= ceiling + settings.curve_margin
    near = ceiling - settings.curve_margin
    if reached >= near or reached < settings.named_share * ceiling:
        return reached >= near
    return not alone_at_noise(with_curve.current, branch.current, with_curve.plain, settings)


def within_reach(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether names may come as far as the curve, if each further one gains what the newest did.

    The first one says nothing of that: two laws may need one another. Later ones seldom gain more than those before them.
    """
    if len(_added(with_curve, branch)) < 2:
        return True
    reached, ceiling = gains(with_curve, branch)
    newest = branch.steps[-1].parent.score - branch.current.score
    further = study.budget.most_effects - len(branch.effects)
    return reached + further * newest >= study.settings.named_share * ceiling


def in_pieces(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether named effects at the curve's port are pieces of it, and none is the machine's.

    True where there are more than ``most_names_for_curve`` of them. Also true where two, there or at a body that springs join with it,
    depend on the curve's own signal, which can draw any smooth curve between them, and the curve still removes, beyond chance, some of
    what they leave.
    """
    done, settings = with_curve.steps[-1], study.settings
    curve = None if done.taken is None else done.taken.candidate.attachment
    if curve is None:
        return False
    added = _added(with_curve, branch)
    if sum(e.port == curve.port for e in added) > settings.most_names_for_curve:
        return True
    near = _joined_with(study, curve.port)
    added = [e for e in added if e.port in near]
    if len(added) < 2 or not all(getattr(curve.mechanism, "signal", None) in e.mechanism.needs for e in added):
        return False
    further = partial(window_significance, branch.current, with_curve.current, settings)
    return with_curve.current.score < branch.current.score and further() > settings.least_significance


def many_names(study: Study, with_curve: SearchState, branch: SearchState) -> bool:
    """Whether ``branch`` has more effects in the place of the curve than ``most_names_for_curve``, wherever they are."""
    return len(_added(with_curve, branch)) > study.settings.most_names_for_curve


def before_pieces(start: SearchState, with_curve: SearchState, branch: SearchState) -> SearchState | None:
    """What to ask of names that are pieces of a curve, where that does not hold: those that went farther than the curve before others
    joined them, else the first one; None where the first step from ``start`` took none.

    Seen: a stage's constant force and dry friction went farther than the curve; with a ripple and a stop beside them all four were pieces,
    and the constant force alone was told.
    """
    grown = list(_one_by_one(start, branch))
    farther = (s for s in grown[:-1] if s.current.score < with_curve.current.score)
    return next(farther, grown[0] if grown else None)


def _one_by_one(start: SearchState, branch: SearchState) -> Iterator[SearchState]:
    """``branch`` after each of its steps from ``start`` that took an effect."""
    for count in range(len(start.steps) + 1, len(branch.steps) + 1):
        steps = branch.steps[:count]
        if steps[-1].taken is None:
            return
        yield replace(branch.at(steps[-1].taken.fitted), steps=steps)


def gains(with_curve: SearchState, branch: SearchState) -> tuple[float, float]:
    """What named effects gain and what the curve does, from the hypothesis that both build on."""
    before = with_curve.steps[-1].parent.score
    return before - branch.current.score, before - with_curve.current.score


def _joined_with(study: Study, port: str) -> set[str]:
    """A port and, where it is a body, the bodies that springs join with it: at either end of a spring a force does nearly the same."""
    groups = ({body.name for body in group} for group in joined_bodies(study.problem.model))
    return next((group for group in groups if port in group), {port})


def _added(with_curve: SearchState, branch: SearchState) -> list[Attachment]:
    """The effects of ``branch`` that stand in the place of the curve."""
    return [e for e in branch.effects if e not in with_curve.steps[-1].parent.effects]
