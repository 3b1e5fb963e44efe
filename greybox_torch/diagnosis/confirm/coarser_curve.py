"""A free curve as it was drawn first, where held-out experiments follow a finer one less well.

How fine a curve is drawn is chosen by the experiments that it is fitted to: of many knots each may have been passed once or twice, and
follows what was particular there. Seen: a brake along a part of a rail, whose curve of 14 knots removed 64 % of the held-out error; of 56
knots, which fitted half as much again, it added 66 %, and names that are not the machine's were told in its place.
"""

from __future__ import annotations

from greybox_torch.diagnosis.confirm.held_out import HeldOut, gain
from greybox_torch.diagnosis.hypothesis.fit import Hypothesis
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import Stage
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown


def with_coarser_curve(study: Study, state: SearchState, others: HeldOut) -> Stage[SearchState]:
    """The state with its curve as the screen drew it, where that is better beyond chance on held-out experiments; else as it is."""
    curve = next((e for e in state.effects if isinstance(e.mechanism, Unknown)), None)
    coarse = None if curve is None else _as_drawn_first(study, state, curve)
    if coarse is None:
        return state
    better = gain(others.fits(state.current), others.fits(coarse))
    if better.share <= 0.0 or better.errors_away <= study.settings.held_out_beyond_chance:
        return state
    state = state.at(coarse)
    yield state
    return (yield from drop_superfluous(study, state))


def _as_drawn_first(study: Study, state: SearchState, curve: Attachment) -> Hypothesis | None:
    """The hypothesis with the curve of the step that took it; None where that has as many knots."""
    done = state.step_of(curve.prefix)
    first = None if done is None or done.taken is None else done.taken
    if first is None or _knots(first.candidate.attachment) >= _knots(curve):
        return None
    if len(state.effects) == 1:
        return first.fitted
    study.working_on("drawing the curve more coarsely")
    starts = {**state.current.values(), **_of(curve, first.fitted)}
    effects = state.with_law(curve, first.candidate.attachment)
    return fit(study, effects, [starts], state.current.fits[0], limits=study.budget.window_iterations)


def _knots(curve: Attachment) -> int:
    return getattr(curve.mechanism, "knots", 0)


def _of(curve: Attachment, fitted: Hypothesis) -> dict[str, float]:
    """The parameters of a curve as they were fitted."""
    return {name: value for name, value in fitted.values().items() if name.startswith(f"{curve.prefix}.")}
