"""Where too few windows show what removes most of the error, one more experiment is taken to choose with."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from greybox_torch.data import DataSet
from greybox_torch.diagnosis.confirm.held_out import HeldOut, gain
from greybox_torch.diagnosis.confirm.promotion import Promotion
from greybox_torch.diagnosis.hypothesis.significance import over_the_same_windows
from greybox_torch.diagnosis.one_of import spoken_at
from greybox_torch.diagnosis.refit.ranked import RankedCandidate, sound
from greybox_torch.diagnosis.select.state import SearchState
from greybox_torch.diagnosis.study import Study


def promote_doubtful(study: Study, dataset: DataSet, state: SearchState, others: HeldOut) -> Promotion | None:
    """The data set with the validation experiment among those to choose with that a doubtful law predicts best beside the model as it
    stands: one that removes most of the error, as windows of the held-out experiments bear out, and those of the others leave open.

    None where names were found, where there is no such law, or where no validation experiment would be left. Seen: a real motor's friction,
    61 % of the error and 2.7 standard errors over the few windows of one short experiment: every law was as unsure, a curve was told in
    their place (0.97).
    """
    recordings, settings = dataset.validation(), study.settings
    if len(recordings) < 2 or not _nothing_but_a_curve(state):
        return None
    law = max(_doubtful(study, state), key=lambda r: r.gain, default=None)
    if law is None:
        return None
    removed = gain(others.fits(state.plain), others.fits(law.fitted))
    if removed.share <= settings.most_of_the_mismatch or removed.errors_away <= settings.held_out_beyond_chance:
        return None
    best = int(np.argmax(others.times_noise(state.plain) / others.times_noise(law.fitted)))
    why = (
        f"{spoken_at(*law.candidate.attachment.named[::-1])} removes {100 * removed.share:.2g} % of the squared error of held-out windows, "
        "and the experiments to choose with have too few to say so"
    )
    return Promotion.of(dataset, recordings[best].name, why)


def _nothing_but_a_curve(state: SearchState) -> bool:
    return not state.effects or (len(state.effects) == 1 and state.has_curve)


def _doubtful(study: Study, state: SearchState) -> Iterator[RankedCandidate]:
    """The named laws beside no effect that remove most of the error, that far from chance over windows that it may be."""
    settings = study.settings
    for step in state.steps:
        if step.parent.effects or not over_the_same_windows(step.parent, state.plain):
            continue
        for law in step.ranked:
            unsure = settings.least_significance_of_doubtful < law.significance <= settings.least_significance
            if unsure and not law.unknown and law.removed > settings.most_of_the_mismatch and sound(study, law):
                yield law
