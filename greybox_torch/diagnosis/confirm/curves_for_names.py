"""Free curves in the place of several names, each at another port, that are rough forms of laws which the library does not have.

Beside the others a curve in the place of one name does not reach the noise, so that the name stands for it. In the place of all of them at
once curves may. Seen: a plate that radiates, of whose three zones one was told to lose heat above a threshold, two to leak to a room at 80
degC (0.97 each), where the room was at 22 degC.
"""

from __future__ import annotations

from dataclasses import replace

from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.refit.curve import drawing, may_be_drawn
from greybox_torch.diagnosis.refit.refitted import fit
from greybox_torch.diagnosis.select.backward import drop_superfluous
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.stopping import result_of
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment


def curves_for_names(study: Study, state: SearchState, judged: Judgement) -> SearchState | None:
    """``state`` with free curves in the place of all names that a curve of the same signal at the same port surely outdoes.

    None where these are fewer than two or share a port, or where free runs leave little, or nothing but noise.
    """
    settings = study.settings
    share, times, _ = judged.left(True)
    curves = {e.prefix: c for e in state.effects if (c := _outdone_by(study, state, e)) is not None}
    ports = {c.port for c in curves.values()}
    asked = share > settings.least_size and times > settings.far_above_noise
    if not asked or len(ports) < 2 or len(ports) < len(curves):
        return None
    study.working_on("drawing curves in the place of several names")
    drawn = state.current
    values = drawn.values()
    for law in (e for e in state.effects if e.prefix in curves):
        curve = curves[law.prefix]
        heights = drawing(drawn, law, curve, study.surroundings)
        rest = {n: v for n, v in values.items() if not n.startswith(f"{law.prefix}.")}
        values = rest | {n: v for n, v in heights.items() if n.startswith(f"{curve.prefix}.")}
    effects = tuple(curves.get(e.prefix, e) for e in state.effects)
    fitted = fit(study, effects, [values], drawn.fits[0], limits=study.budget.window_iterations)
    if fitted is None or fitted.score > drawn.score - settings.curve_margin * len(curves):
        return None
    return result_of(drop_superfluous(study, replace(state.at(fitted), named=state)))


def _outdone_by(study: Study, state: SearchState, law: Attachment) -> Attachment | None:
    """The free curve that was fitted in the place of a named law and gained surely more; None where there is none."""
    step = state.step_beside_others(law.prefix)
    if law.mechanism.free or step is None or step.taken is None:
        return None
    farther = step.taken.gain + study.settings.curve_margin
    curves = (r for r in step.ranked if r.unknown and r.gain > farther)
    return next(
        (r.candidate.attachment for r in curves if may_be_drawn(law, r.candidate.attachment, study.surroundings)), None
    )
