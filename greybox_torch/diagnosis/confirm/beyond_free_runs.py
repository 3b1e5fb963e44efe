"""What windows bear out and free runs cannot: experiments that no free run follows for long."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.confirm.curve_instead import curves_of, first_with_curves
from greybox_torch.diagnosis.confirm.held_out import Gain, HeldOut, gain
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings
from greybox_torch.diagnosis.study import Study
from greybox_torch.mechanisms.attachment import Attachment
from greybox_torch.mechanisms.unknown import Unknown


def said_of_windows(
    before: SearchState, after: SearchState, gains: Mapping[str, Gain], judged: Judgement, settings: DiagnosisSettings
) -> tuple[str, ...]:
    """A sentence for every effect that free runs alone took back, where those of the plain model are lost as well.

    A machine near an unstable equilibrium, or one that integrates twice, leaves any free run: which model is lost farther away says little.

    Args:
        before: the effects with the one that was taken back, ``after`` without it.
        gains: of the effects of ``before``, on held-out experiments.
    """
    if not _all_are_lost(judged):
        return ()
    gone = [e for e in before.effects if e.prefix in gains and e.prefix not in after.prefixes]
    why = "was taken back because free runs of the validation experiments come out worse with it"
    return tuple(
        _said(e, gains[e.prefix], why) for e in gone if gains[e.prefix].errors_away > settings.held_out_beyond_chance
    )


def said_of_the_curve(
    study: Study, searched: SearchState, others: HeldOut | None, judged: Judgement
) -> tuple[str, ...]:
    """The same of the free curve that led the first step, where nothing that came in its place lasted.

    Seen: a multicopter whose battery sags. For 40 s the search told of an unknown effect at its actuator, 97 % of the mismatch; names for
    it were taken back, and the verdict said that no curve explains it.
    """
    step = first_with_curves(study, searched)
    if others is None or step is None or not _all_are_lost(judged):
        return ()
    best = curves_of(study, step)[0]
    shown = gain(others.fits(step.parent), others.fits(best.fitted))
    beyond = shown.errors_away > study.settings.held_out_beyond_chance
    why = "is not told, as free runs of the validation experiments do not bear it out"
    return (_said(best.candidate.attachment, shown, why),) if beyond else ()


def _all_are_lost(judged: Judgement) -> bool:
    """Whether free runs of the plain model follow the validation experiments no better than a constant."""
    fits = [s.fit for s in judged.refit.scores if s.role == "validation"]
    return bool(fits) and float(np.mean(fits)) < 0.0  # in %


def _said(effect: Attachment, shown: Gain, why: str) -> str:
    law = effect.mechanism
    named = spoken_at(Unknown.name if law.free else law.name, effect.port)
    return (
        f"{named[0].upper()}{named[1:]} removes {100 * shown.share:.3g} % of the held-out squared error over windows, and {why}. Those "
        "without it are lost, too: no free run follows this machine for long, so that the windows say more."
    )
