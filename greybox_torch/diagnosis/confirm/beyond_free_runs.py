"""What windows bear out and free runs cannot: experiments that no free run follows for long."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from greybox_torch.diagnosis.confirm.held_out import Gain
from greybox_torch.diagnosis.confirm.judgement import Judgement
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.settings import DiagnosisSettings


def said_of_windows(
    before: SearchState, after: SearchState, gains: Mapping[str, Gain], judged: Judgement, settings: DiagnosisSettings
) -> tuple[str, ...]:
    """A sentence for every effect that free runs alone took back, where those of the plain model are lost as well.

    A machine near an unstable equilibrium, or one that integrates twice, leaves any free run: which model is lost farther away says little.

    Args:
        before: the effects with the one that was taken back, ``after`` without it.
        gains: of the effects of ``before``, on held-out experiments.
    """
    fits = [s.fit for s in judged.refit.scores if s.role == "validation"]
    if not fits or not np.mean(fits) < 0.0:  # no better than a constant, in %
        return ()
    gone = [e for e in before.effects if e.prefix in gains and e.prefix not in after.prefixes]
    return tuple(
        f"{spoken_at(e.mechanism.name, e.port)} removes {100 * gains[e.prefix].share:.3g} % of the held-out squared error over "
        "windows, and was taken back because free runs of the validation experiments come out worse with it. Those without it are lost, "
        "too: no free run follows this machine for long, so that the windows say more."
        for e in gone
        if gains[e.prefix].errors_away > settings.held_out_beyond_chance
    )
